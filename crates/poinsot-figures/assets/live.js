"use strict";
// The lines of a running filter, which its server sends as events: a table, and a curve for each number.
(() => {
  const POINTS = 4000;
  const live = document.getElementById("live");
  const colour = name => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
  const at = id => document.getElementById(id);
  const digits = (x, n) => x === null ? "\u2013" : String(Number(x.toPrecision(n)));
  const tones = { determined: "good", converging: "fair", inconsistent: "bad", stale: "bad" };
  const curves = new Map();

  const state = word => { live.dataset.state = word; };

  class Curve {
    constructor(name) {
      this.data = [[], [], [], []];
      const figure = document.createElement("figure"), caption = document.createElement("figcaption");
      caption.textContent = name;
      this.place = document.createElement("div");
      figure.append(caption, this.place);
      at("curves").append(figure);
      const axis = { stroke: () => colour("soft"), grid: { stroke: () => colour("grid"), width: 1 }, font: "12px system-ui, sans-serif" };
      const edge = { stroke: "transparent", points: { show: false } };
      this.plot = new uPlot({
        width: this.place.clientWidth || 800, height: 180, legend: { show: false }, scales: { x: { time: false } },
        axes: [axis, { ...axis, size: 76 }],
        series: [{}, { stroke: () => colour("c0"), width: 1.6 }, edge, edge],
        bands: [{ series: [3, 2], fill: () => `rgba(${colour("shade")}, .2)` }],
      }, this.data, this.place);
    }
    take(time, n) {
      if (n.value === null) return;
      const row = [time, n.value, n.value - 1.96 * n.sigma, n.value + 1.96 * n.sigma];
      this.data.forEach((column, k) => column.push(row[k]));
      if (this.data[0].length > POINTS) this.data = this.data.map(c => c.filter((_, k) => k % 2 === 0 || k > POINTS / 2));
      this.changed = true;
    }
    draw() {
      if (!this.changed) return;
      this.changed = false;
      const wide = this.place.clientWidth;
      if (wide && wide !== this.plot.width) this.plot.setSize({ width: wide, height: 180 });
      this.plot.setData(this.data);
    }
  }

  // Text only: a name cannot become markup.
  const cells = (row, texts) => row.replaceChildren(...texts.map((text, k) => {
    const cell = document.createElement(k ? "td" : "th");
    cell.textContent = text;
    return cell;
  }));

  let last = null;
  const show = () => {
    for (const curve of curves.values()) curve.draw();
    live.className = "live " + (tones[last.health] || "");
    at("health").textContent = last.health;
    at("clock").textContent = `${last.time_s.toFixed(1)} s of the record`;
    const names = Object.keys(last.numbers), body = at("numbers");
    while (body.rows.length < names.length) body.insertRow();
    names.forEach((name, k) => {
      const n = last.numbers[name];
      cells(body.rows[k], [name, digits(n.value, 6), digits(n.sigma, 2), digits(n.wanted_sigma, 2), digits(n.reached_at_s, 3)]);
    });
    const kinds = ["gyro", "attitude", "position"].filter(k => last[k].accepted + last[k].gated);
    at("counts").textContent = kinds.map(k => `${k}: ${last[k].accepted} used, ${last[k].gated} left out`).join("; ");
    at("certified").hidden = !last.certified;
    if (last.certified) at("certified").textContent = `All rows up to ${last.certified.time_s.toFixed(1)} s, identified: ${last.certified.verdict}`;
    live.dataset.points = Math.max(0, ...[...curves.values()].map(c => c.data[0].length));
  };

  const events = new EventSource("events");
  events.onopen = () => state("connected");
  events.onerror = () => state("reconnecting");
  events.addEventListener("end", () => { events.close(); state("ended"); at("clock").textContent += ", which has ended"; });
  events.onmessage = event => {
    const first = !last;
    last = JSON.parse(event.data);
    for (const [name, n] of Object.entries(last.numbers)) {
      if (!curves.has(name)) curves.set(name, new Curve(name));
      curves.get(name).take(last.time_s, n);
    }
    if (first || !show.waits) { show.waits = true; requestAnimationFrame(() => { show.waits = false; show(); }); }
  };
})();
