"use strict";
// Plots over time, drawn by uPlot when they come into view. Plots of one group share zoom and cursor; the cursor stands
// at the nearest sample. The picture in space follows it through the event "poinsot:time".
(() => {
  const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3]];
  const style = getComputedStyle(document.documentElement);
  const colour = name => style.getPropertyValue("--" + name).trim();
  const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0)).buffer;
  const digits = n => String(n).replace(/[-0-9]/g, c => c === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[c]);
  const groups = new Map();

  // Columns as uPlot wants them: one row of times, values with null for what is missing.
  const columns = data => {
    const times = [], tables = new Map();
    data.series.forEach((s, k) => {
      times[k] = s.same === null ? Float64Array.from(new Float32Array(bytes(s.x)), t => s.start + t) : times[s.same];
      const y = Array.from(new Uint16Array(bytes(s.y)), v => v === 65535 ? null : s.low + s.step * v);
      if (!tables.has(times[k])) tables.set(times[k], []);
      tables.get(times[k]).push([k, y]);
    });
    const parts = [...tables];
    const joined = parts.length === 1
      ? [parts[0][0], ...parts[0][1].map(p => p[1])]
      : uPlot.join(parts.map(([x, rows]) => [Array.from(x), ...rows.map(r => r[1])]));
    const order = parts.flatMap(p => p[1].map(r => r[0]));
    return [joined[0], ...data.series.map((_, k) => joined[1 + order.indexOf(k)])];
  };

  class Chart {
    constructor(figure) {
      this.figure = figure;
      this.place = figure.querySelector(".canvas");
      this.data = JSON.parse(figure.querySelector(".curves-data").textContent);
    }
    draw() {
      const wide = this.place.clientWidth;
      if (!wide) return;
      if (this.plot) { if (this.plot.width !== wide) this.plot.setSize({ width: wide, height: this.plot.height }); return; }
      const d = this.data, table = columns(d);
      const largest = Math.max(...table.slice(1).map(c => c.reduce((m, v) => v === null ? m : Math.max(m, Math.abs(v)), 0)), 1e-300);
      this.power = largest >= 0.01 && largest < 1e4 ? 0 : 3 * Math.floor(Math.log10(largest) / 3);
      const scale = 10 ** -this.power;
      for (const column of table.slice(1)) column.forEach((v, i) => { if (v !== null) column[i] = v * scale; });
      const unit = ((this.power ? "10" + digits(this.power) + " " : "") + d.y[1]).trim();
      this.scale = scale;
      const mates = groups.get(d.group) || [];
      groups.set(d.group, [...mates, this]);
      const axis = label => ({ label, labelSize: 22, size: 52, font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif",
        stroke: () => colour("soft"), grid: { stroke: () => colour("grid"), width: 1 }, ticks: { stroke: () => colour("rule"), width: 1, size: 4 } });
      this.legend(table, unit);
      this.plot = new uPlot({
        width: wide, height: d.height || 220, padding: [8, 16, 0, 0], legend: { show: false },
        scales: { x: { time: false } },
        axes: [{ ...axis(d.x[0] + " [" + d.x[1] + "]"), size: 36, labelSize: 18 }, axis(d.y[0] + (unit ? " [" + unit + "]" : ""))],
        cursor: {
          sync: { key: d.group, setSeries: false, scales: ["x", null] },
          y: false,
          move: (u, left, top) => left < 0 ? [left, top] : [u.valToPos(u.data[0][u.posToIdx(left)], "x"), top],
          drag: { x: true, y: false },
        },
        series: [{}, ...d.series.map((s, k) => ({
          stroke: colour("c" + s.colour), width: s.mark === "dots" ? 0 : 1.6, paths: s.mark === "dots" ? () => null : undefined,
          dash: s.mark === "dashed" ? [6, 4] : DASHES[s.colour % DASHES.length],
          points: s.mark === "dots" ? { show: true, size: 3, fill: colour("c" + s.colour), width: 0 } : { show: false },
        }))],
        hooks: {
          drawClear: [u => this.under(u)],
          setCursor: [u => this.read(u)],
          setScale: [(u, key) => key === "x" && this.spread(u)],
        },
      }, table, this.place);
      this.home = [table[0][0], table[0][table[0].length - 1]];
      this.place.addEventListener("keydown", e => this.key(e));
      const touch = e => {
        const box = this.plot.over.getBoundingClientRect();
        this.plot.setCursor({ left: e.touches[0].clientX - box.left, top: e.touches[0].clientY - box.top });
      };
      this.plot.over.addEventListener("touchstart", touch, { passive: true });
      this.plot.over.addEventListener("touchmove", touch, { passive: true });
      this.plot.over.addEventListener("dblclick", () => this.zoom(...this.home));
    }
    legend(table, unit) {
      const caption = this.figure.querySelector("figcaption");
      this.words = this.data.series.map((s, k) => {
        if (!s.name) return null;
        const key = document.createElement("span"), value = document.createElement("output");
        key.className = "key c" + s.colour + " " + (s.mark === "dots" ? "dots" : "line d" + s.colour % DASHES.length);
        key.textContent = s.name + " ";
        key.appendChild(value);
        caption.appendChild(key);
        return value;
      });
      this.time = document.createElement("output");
      this.time.className = "when";
      caption.appendChild(this.time);
      const save = document.createElement("button");
      save.type = "button";
      save.textContent = "CSV";
      save.setAttribute("aria-label", "Save the curves of " + this.data.title + " as CSV");
      save.addEventListener("click", () => {
        const cell = v => v === null || v === undefined ? "" : +(v / this.scale).toPrecision(6);
        const head = ["time_s", ...this.data.series.map((s, k) => '"' + (s.name || "measured " + (this.data.series[k + 1] || {}).name) + " " + this.data.y[1] + '"')];
        const rows = Array.from(table[0], (t, i) => [+t.toFixed(6), ...table.slice(1).map(c => cell(c[i]))].join(","));
        window.poinsotSave(this.data.title.replace(/[^A-Za-z0-9]+/g, "_") + ".csv", [head.join(","), ...rows].join("\n") + "\n");
      });
      caption.appendChild(save);
      this.unit = unit;
    }
    // Band of two sigma and lines across, below the curves.
    under(u) {
      const { left, top, width, height } = u.bbox, g = u.ctx;
      g.save();
      g.beginPath(); g.rect(left, top, width, height); g.clip();
      if (this.data.band) {
        const half = this.data.band * this.scale, high = u.valToPos(half, "y", true), low = u.valToPos(-half, "y", true);
        g.fillStyle = colour("c2"); g.globalAlpha = 0.14; g.fillRect(left, high, width, low - high); g.globalAlpha = 1;
      }
      g.strokeStyle = colour("soft"); g.setLineDash([4, 4]);
      for (const [level] of this.data.levels) {
        const y = u.valToPos(level * this.scale, "y", true);
        g.beginPath(); g.moveTo(left, y); g.lineTo(left + width, y); g.stroke();
      }
      g.restore();
    }
    read(u) {
      const i = u.cursor.idx;
      this.place.dataset.sample = i ?? "";
      this.words.forEach((word, k) => {
        const v = i === null || i === undefined ? null : u.data[k + 1][i];
        if (word) word.textContent = v === null || v === undefined ? "" : v.toPrecision(5);
      });
      const t = i === null || i === undefined ? null : u.data[0][i];
      this.time.textContent = t === null ? "" : "t = " + +t.toPrecision(8) + " s";
      if (t !== null && !this.follows) document.dispatchEvent(new CustomEvent("poinsot:time", { detail: { group: this.data.group, time: t, from: "curves" } }));
    }
    spread(u) {
      const { min, max } = u.scales.x;
      Object.assign(this.place.dataset, { from: min, to: max, group: this.data.group });
      if (Chart.busy || !this.plot) return;
      Chart.busy = true;
      for (const mate of groups.get(this.data.group)) if (mate.plot && mate !== this) mate.plot.setScale("x", { min, max });
      Chart.busy = false;
    }
    zoom(min, max) { this.plot.setScale("x", { min: Math.max(min, this.home[0]), max: Math.min(max, this.home[1]) }); }
    step(by) {
      const u = this.plot, i = Math.min(u.data[0].length - 1, Math.max(0, (u.cursor.idx ?? 0) + by));
      this.at(u.data[0][i]);
    }
    at(time) { this.plot.setCursor({ left: this.plot.valToPos(time, "x"), top: this.plot.over.clientHeight / 2 }); }
    key(e) {
      const { min, max } = this.plot.scales.x, middle = (min + max) / 2, half = (max - min) / 2;
      const act = {
        "+": () => this.zoom(middle - half / 2, middle + half / 2), "-": () => this.zoom(middle - 2 * half, middle + 2 * half),
        "0": () => this.zoom(...this.home), ArrowLeft: () => this.step(e.shiftKey ? -20 : -1), ArrowRight: () => this.step(e.shiftKey ? 20 : 1),
      }[e.key];
      if (act) { e.preventDefault(); act(); }
    }
  }
  const charts = [...document.querySelectorAll("figure.curves")].filter(f => f.querySelector(".curves-data")).map(f => new Chart(f));
  const near = c => { const r = c.place.getBoundingClientRect(); return r.width && r.top < innerHeight + 600 && r.bottom > -600; };
  const look = () => charts.filter(near).forEach(c => c.draw());
  for (const event of ["scroll", "resize"]) addEventListener(event, look, { passive: true });
  addEventListener("beforeprint", () => charts.forEach(c => c.draw()));
  document.addEventListener("poinsot:shown", look);
  document.addEventListener("poinsot:time", e => {
    if (e.detail.from === "curves") return;
    for (const c of groups.get(e.detail.group) || []) if (c.plot) { c.follows = true; c.at(e.detail.time); c.follows = false; }
  });
  look();
})();
