"use strict";
// Zoom and read-out for the plots. The SVG holds the curves; zooming moves a window over its inner field.
(() => {
  const charts = [];
  const numbers = text => text.split(" ").map(Number);
  const make = (name, attributes, parent) => {
    const node = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) node.setAttribute(key, attributes[key]);
    parent.appendChild(node);
    return node;
  };
  const roundStep = raw => {
    const power = 10 ** Math.floor(Math.log10(raw));
    const f = raw / power;
    return (f < 1.5 ? 1 : f < 3.5 ? 2 : f < 7.5 ? 5 : 10) * power;
  };
  const digits = n => String(n).replace(/[-0-9]/g, c => c === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[c]);
  const write = (value, step) => {
    const decimals = Math.min(9, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
    return (Math.abs(value) < 1e-9 * step ? 0 : value).toFixed(decimals).replace("-", "\u2212");
  };

  class Chart {
    constructor(svg) {
      this.svg = svg;
      this.field = svg.querySelector(".field");
      this.box = numbers(svg.dataset.box);
      this.home = { x: numbers(svg.dataset.x), y: numbers(svg.dataset.y) };
      this.log = svg.dataset.log === "1";
      this.group = svg.dataset.group;
      this.reset();
      this.cursor = make("text", { class: "cursor", x: this.box[0] + this.box[2] - 4, y: this.box[1] + 12 }, svg);
      svg.addEventListener("pointerdown", e => this.press(e));
      svg.addEventListener("pointermove", e => this.move(e));
      svg.addEventListener("pointerup", e => this.release(e));
      svg.addEventListener("pointerleave", () => { this.cursor.textContent = ""; });
      svg.addEventListener("dblclick", () => this.share(() => this.home.x, true));
      svg.addEventListener("keydown", e => this.key(e));
    }
    reset() { this.x = [...this.home.x]; this.y = [...this.home.y]; }
    // Place of the pointer in shares of the field, from its left upper corner.
    where(event) {
      const outer = this.svg.getBoundingClientRect();
      const scale = outer.width / this.svg.viewBox.baseVal.width;
      const clamp = v => Math.min(1, Math.max(0, v));
      return [clamp(((event.clientX - outer.left) / scale - this.box[0]) / this.box[2]),
              clamp(((event.clientY - outer.top) / scale - this.box[1]) / this.box[3])];
    }
    press(event) {
      if (event.button !== 0) return;
      this.from = this.where(event);
      this.svg.setPointerCapture(event.pointerId);
      this.select = make("rect", { class: "select" }, this.svg);
    }
    move(event) {
      const at = this.where(event);
      const x = this.x[0] + at[0] * (this.x[1] - this.x[0]);
      const y = this.y[1] - at[1] * (this.y[1] - this.y[0]);
      const value = this.log ? (10 ** y).toExponential(2) : write(y, (this.y[1] - this.y[0]) / 500);
      this.cursor.textContent = write(x, (this.x[1] - this.x[0]) / 500) + " | " + value;
      if (!this.from) return;
      const tall = Math.abs(at[1] - this.from[1]) * this.box[3] > 25;
      const [x0, x1] = [this.from[0], at[0]].sort((a, b) => a - b);
      const [y0, y1] = tall ? [this.from[1], at[1]].sort((a, b) => a - b) : [0, 1];
      this.chosen = { x: [x0, x1], y: [y0, y1], tall };
      const [left, top, w, h] = this.box;
      const set = (k, v) => this.select.setAttribute(k, v);
      set("x", left + x0 * w); set("width", (x1 - x0) * w); set("y", top + y0 * h); set("height", (y1 - y0) * h);
    }
    release() {
      if (this.select) this.select.remove();
      const c = this.chosen;
      this.from = this.select = this.chosen = null;
      if (!c || c.x[1] - c.x[0] < 0.01) return;
      const span = this.y[1] - this.y[0];
      if (c.tall) this.y = [this.y[1] - c.y[1] * span, this.y[1] - c.y[0] * span];
      this.share(() => c.x.map(v => this.x[0] + v * (this.x[1] - this.x[0])), false);
    }
    key(event) {
      const span = this.x[1] - this.x[0];
      const to = { "+": [0.25, -0.25], "=": [0.25, -0.25], "-": [-0.5, 0.5], ArrowLeft: [-0.2, -0.2], ArrowRight: [0.2, 0.2] }[event.key];
      if (event.key === "0" || event.key === "Escape") this.share(() => this.home.x, true);
      else if (to) this.share(() => [this.x[0] + to[0] * span, this.x[1] + to[1] * span], false);
      else return;
      event.preventDefault();
    }
    // The whole group takes the new horizontal range.
    share(range, home) {
      const x = [...range()];
      for (const chart of charts) {
        if (chart !== this && (!this.group || chart.group !== this.group)) continue;
        if (home) chart.reset(); else chart.x = [...x];
        chart.draw();
      }
    }
    draw() {
      const part = (v, range) => 1000 * (v - range[0]) / (range[1] - range[0]);
      const x0 = part(this.x[0], this.home.x), x1 = part(this.x[1], this.home.x);
      const y0 = 1000 - part(this.y[1], this.home.y), y1 = 1000 - part(this.y[0], this.home.y);
      this.field.setAttribute("viewBox", [x0, y0, x1 - x0, y1 - y0].join(" "));
      for (const word of this.svg.querySelectorAll(".level-word")) word.remove();
      const [left, top, w, h] = this.box;
      this.ticks("x", this.x, w / 85, (s, text, g) => {
        const x = left + s * w;
        make("path", { d: `M${x} ${top}v${h}` }, g);
        make("text", { x, y: top + h + 14 }, g).textContent = text;
      });
      this.ticks("y", this.y, Math.max(3, h / 36), (s, text, g) => {
        const y = top + (1 - s) * h;
        make("path", { d: `M${left} ${y}h${w}` }, g);
        make("text", { x: left - 6, y: y + 3.5 }, g).textContent = text;
      });
    }
    ticks(name, range, wanted, put) {
      const g = this.svg.querySelector(".ticks." + name);
      g.replaceChildren();
      const log = this.log && name === "y";
      let step = roundStep((range[1] - range[0]) / wanted);
      if (log || (name === "x" && this.svg.dataset.whole === "1")) step = Math.max(1, Math.round(step));
      for (let k = Math.ceil(range[0] / step); k <= range[1] / step; k++)
        put((k * step - range[0]) / (range[1] - range[0]), log ? "10" + digits(k * step) : write(k * step, step), g);
    }
  }
  for (const svg of document.querySelectorAll("svg.chart:not(.fixed)")) charts.push(new Chart(svg));
})();
