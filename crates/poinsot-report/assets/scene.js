"use strict";
// Wire pictures in space on a canvas: orthographic, turned by mouse, touch and keyboard.
(() => {
  const add = (a, b, s) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const turn = (q, v) => {
    const u = [q[0], q[1], q[2]], t = cross(u, v).map(x => 2 * x);
    return add(add(v, t, q[3]), cross(u, t), 1);
  };
  const mesh = e => {
    const at = (lat, lon) => {
      const s = [Math.cos(lat) * Math.cos(lon), Math.cos(lat) * Math.sin(lon), Math.sin(lat)];
      return e.axes.reduce((p, axis, k) => add(p, axis, s[k]), e.centre);
    };
    const ring = f => Array.from({ length: 61 }, (_, i) => f(i * Math.PI / 30));
    const lines = [];
    for (let m = 0; m < 6; m++) lines.push(ring(t => at(t, m * Math.PI / 6)));
    for (let p = -2; p <= 2; p++) lines.push(ring(t => at(p * Math.PI / 6, t)));
    return lines;
  };

  class Picture {
    constructor(figure) {
      this.data = JSON.parse(figure.querySelector(".scene-data").textContent);
      this.meshes = this.data.ellipsoids.map(e => ({ e, lines: mesh(e) }));
      this.yaw = -0.9; this.pitch = 0.42; this.zoom = 1; this.frame = 0; this.space = !!(this.data.rolling && this.data.rolling.from_space);
      const stage = figure.querySelector(".stage");
      this.canvas = document.createElement("canvas");
      this.canvas.tabIndex = 0;
      this.canvas.setAttribute("role", "img");
      this.canvas.setAttribute("aria-label", this.data.title + " (drag or arrow keys to turn)");
      stage.appendChild(this.canvas);
      stage.classList.add("live");
      this.measure();
      this.controls(figure, stage);
      const c = this.canvas;
      c.addEventListener("pointerdown", e => { this.hold = [e.clientX, e.clientY]; c.setPointerCapture(e.pointerId); });
      c.addEventListener("pointerup", () => { this.hold = null; });
      c.addEventListener("pointermove", e => {
        if (!this.hold) return;
        this.rotate((this.hold[0] - e.clientX) / 150, (e.clientY - this.hold[1]) / 150);
        this.hold = [e.clientX, e.clientY];
      });
      c.addEventListener("keydown", e => {
        const to = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[e.key];
        if (to) this.rotate(...to);
        else if (e.key === "+" || e.key === "=") this.zoom *= 1.15;
        else if (e.key === "-") this.zoom /= 1.15;
        else return;
        e.preventDefault();
        this.draw();
      });
      new ResizeObserver(() => this.draw()).observe(c);
      matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
    }
    measure() {
      const low = [1e300, 1e300, 1e300], high = [-1e300, -1e300, -1e300];
      const take = p => { for (let k = 0; k < 3; k++) { low[k] = Math.min(low[k], p[k]); high[k] = Math.max(high[k], p[k]); } };
      for (const m of this.meshes) if (!m.e.faint || this.meshes.length < 2) m.lines.flat().forEach(take);
      this.data.curves.forEach(c => c.points.filter(Boolean).forEach(take));
      this.data.arrows.forEach(a => take(a.to));
      this.data.spots.forEach(s => take(s.at));
      this.centre = this.data.rolling ? [0, 0, 0] : low.map((v, k) => (v + high[k]) / 2);
      this.extent = Math.max(...low.map((v, k) => high[k] - v)) / 2 || 1;
      this.radius = this.data.rolling ? this.extent / 0.36 : Math.hypot(...low.map((v, k) => high[k] - v)) / 1.15 || 1;
    }
    controls(figure, stage) {
      const bar = document.createElement("div");
      bar.className = "controls";
      const button = (text, act) => { const b = document.createElement("button"); b.type = "button"; b.textContent = text; b.addEventListener("click", () => act(b)); bar.appendChild(b); return b; };
      const roll = this.data.rolling;
      if (roll && roll.time_s.length) {
        const play = button("play", () => this.play(play));
        const other = () => this.space ? "see from the body" : "see from space";
        button(other(), b => { this.space = !this.space; b.textContent = other(); this.draw(); });
        this.slider = document.createElement("input");
        Object.assign(this.slider, { type: "range", min: 0, max: roll.time_s.length - 1, value: 0 });
        this.slider.setAttribute("aria-label", "time");
        this.slider.addEventListener("input", () => { this.frame = +this.slider.value; this.draw(); });
        bar.appendChild(this.slider);
        this.clock = document.createElement("span");
        bar.appendChild(this.clock);
        const defined = roll.pole.map((p, k) => p ? k : -1).filter(k => k >= 0);
        this.frame = defined[defined.length >> 1] || 0;
        this.slider.value = this.frame;
      }
      button("reset view", () => { this.yaw = -0.9; this.pitch = 0.42; this.zoom = 1; this.draw(); });
      const hint = document.createElement("span");
      hint.textContent = "drag or arrow keys turn, + and \u2212 zoom";
      bar.appendChild(hint);
      stage.after(bar);
    }
    play(button) {
      this.playing = !this.playing;
      button.textContent = this.playing ? "pause" : "play";
      const frames = this.data.rolling.time_s.length, begin = performance.now(), from = this.frame;
      const step = now => {
        if (!this.playing) return;
        this.frame = (from + Math.floor((now - begin) / 20000 * frames)) % frames;
        this.slider.value = this.frame;
        this.draw();
        requestAnimationFrame(step);
      };
      requestAnimationFrame(step);
    }
    rotate(yaw, pitch) {
      this.yaw += yaw;
      this.pitch = Math.max(-1.57, Math.min(1.57, this.pitch + pitch));
      this.draw();
    }
    draw() {
      const c = this.canvas, ratio = devicePixelRatio || 1, wide = c.clientWidth, high = Math.round(wide * 0.56);
      if (!wide) return;
      if (c.width !== Math.round(wide * ratio)) { c.width = Math.round(wide * ratio); c.height = Math.round(high * ratio); }
      const g = this.g = c.getContext("2d"), style = getComputedStyle(document.documentElement);
      const colour = name => style.getPropertyValue("--" + name).trim();
      g.setTransform(ratio, 0, 0, ratio, 0, 0);
      g.clearRect(0, 0, wide, high);
      g.font = "12px system-ui, sans-serif";
      g.lineJoin = "round";
      const [sy, cy, sp, cp] = [Math.sin(this.yaw), Math.cos(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch)];
      const right = [-sy, cy, 0], up = [-sp * cy, -sp * sy, cp], towards = [cp * cy, cp * sy, sp];
      const scale = this.zoom * high / this.radius;
      const roll = this.data.rolling, k = this.frame;
      const body = p => roll && this.space ? turn(roll.q_xyzw[k], p) : p;
      const flat = p => { const d = add(p, this.centre, -1); return [wide / 2 + scale * dot(d, right), high / 2 - scale * dot(d, up)]; };
      const line = (points, alpha, width, dash) => {
        g.beginPath();
        let pen = false;
        for (const p of points) { if (!p) { pen = false; continue; } const s = flat(p); if (pen) g.lineTo(...s); else g.moveTo(...s); pen = true; }
        g.globalAlpha = alpha; g.lineWidth = width; g.setLineDash(dash); g.stroke();
        g.globalAlpha = 1; g.setLineDash([]);
      };
      // The part of a line before or behind the centre; one point more so that nothing is torn.
      const side = (points, front, centre = [0, 0, 0]) => {
        const seen = p => p && (dot(add(p, centre, -1), towards) >= 0) === front;
        return points.map((p, i) => seen(p) || seen(points[i - 1]) ? p : null);
      };
      for (const { e, lines } of this.meshes) {
        g.strokeStyle = colour("c" + e.colour);
        const centre = body(e.centre);
        for (const raw of lines) {
          const points = raw.map(body);
          for (const front of [false, true]) {
            line(side(points, front, centre), (front ? 0.9 : 0.25) * (e.faint ? 0.5 : 1), 0.9, e.faint ? [2, 3] : []);
          }
        }
      }
      if (roll && roll.pole[k]) this.plane(roll, k, body, flat, line, colour);
      for (const curve of this.data.curves) {
        g.strokeStyle = colour("c" + curve.colour);
        const points = curve.points.map(p => p && body(p)), dash = curve.dashed ? [5, 4] : [];
        const alpha = curve.faint ? 0.35 : 1, width = curve.faint ? 1 : 2;
        if (!roll) { line(points, alpha, width, dash); continue; }
        for (const front of [false, true]) line(side(points, front), front ? alpha : 0.35 * alpha, width, dash);
      }
      for (const a of this.data.arrows) {
        g.strokeStyle = colour("c" + a.colour);
        line([body(a.from), body(a.to)], 1, 1.6, []);
        this.word(a.label, flat(body(a.to)), colour("ink"));
      }
      for (const s of this.data.spots) {
        const at = flat(body(s.at));
        g.fillStyle = colour("c" + s.colour);
        g.beginPath(); g.arc(...at, 4, 0, 7); g.fill();
        this.word(s.label, [at[0], at[1] + 18], colour("ink"));
      }
      if (roll && roll.pole[k]) {
        g.fillStyle = colour("c1");
        g.beginPath(); g.arc(...flat(body(roll.pole[k])), 5, 0, 7); g.fill();
      }
      if (this.clock) this.clock.textContent = "t = " + roll.time_s[k].toPrecision(5) + " s" + (roll.pole[k] ? "" : " (nearly at rest)");
    }
    plane(roll, k, body, flat, line, colour) {
      const g = this.g, n = body(roll.normal[k]), pole = body(roll.pole[k]);
      const help = Math.abs(n[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
      let u = cross(help, n);
      u = u.map(x => x / Math.hypot(...u));
      const v = cross(n, u), half = 0.8 * this.extent;
      // The plane hangs on its foot below the centre, so that it lies still while the body rolls on it.
      const middle = this.space ? n.map(x => x * dot(n, pole)) : pole;
      const at = (a, b) => add(add(middle, u, a * half), v, b * half);
      g.beginPath();
      [[-1, -1], [1, -1], [1, 1], [-1, 1]].forEach((s, i) => g[i ? "lineTo" : "moveTo"](...flat(at(...s))));
      g.closePath();
      g.fillStyle = g.strokeStyle = colour("c6");
      g.globalAlpha = 0.18; g.fill(); g.globalAlpha = 1; g.lineWidth = 1; g.stroke();
      for (let i = -3; i <= 3; i++) { line([at(i / 4, -1), at(i / 4, 1)], 0.3, 1, []); line([at(-1, i / 4), at(1, i / 4)], 0.3, 1, []); }
      if (!this.space) return;
      g.strokeStyle = colour("c7");
      line(roll.pole.slice(0, k + 1).map((p, j) => p && turn(roll.q_xyzw[j], p)), 0.9, 1.5, []);
    }
    word(text, at, ink) { this.g.fillStyle = ink; this.g.fillText(text, at[0] + 7, at[1] - 5); }
  }
  for (const figure of document.querySelectorAll("figure.scene")) new Picture(figure).draw();
})();
