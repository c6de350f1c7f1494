"use strict";
// Pictures in space: lit solids, tubes and translucent planes by WebGL2. Without it the still picture stays.
(() => {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const add = (a, b, f = 1) => [a[0] + f * b[0], a[1] + f * b[1], a[2] + f * b[2]];
  const unit = a => { const n = Math.hypot(...a) || 1; return [a[0] / n, a[1] / n, a[2] / n]; };
  const turn = (q, p) => { const v = [q[0], q[1], q[2]], t = cross(v, p); return add(add(p, t, 2 * q[3]), cross(v, t), 2); };
  const about = (axis, angle) => { const s = Math.sin(angle / 2); return [axis[0] * s, axis[1] * s, axis[2] * s, Math.cos(angle / 2)]; };
  const times = (a, b) => { const v = add(add(cross(a, b), b, a[3]), a, b[3]); return [...v, a[3] * b[3] - dot(a, b)]; };
  const sideways = n => { const u = unit(cross(Math.abs(n[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], n)); return [u, cross(n, u)]; };
  const STILL = [0, 0, 0, 1], TUBE = 8, SPEED = 0.12, SECONDS = 24;
  // Colours along time, from dark to light: they differ in lightness, so that every eye tells them apart.
  const RAMP = [[0.05, 0.12, 0.36], [0.2, 0.3, 0.47], [0.42, 0.44, 0.47], [0.66, 0.61, 0.43], [0.93, 0.83, 0.29]];
  const ramp = s => {
    const x = Math.max(0, Math.min(0.9999, s)) * (RAMP.length - 1), k = Math.floor(x);
    return [0, 1, 2].map(c => RAMP[k][c] + (x - k) * (RAMP[k + 1][c] - RAMP[k][c]));
  };
  const VERTEX = `#version 300 es
    in vec3 at; in vec3 normal; in vec4 ink; uniform mat4 place; uniform mat3 turned; out vec3 n; out vec4 c;
    void main() { gl_Position = place * vec4(at, 1.0); n = turned * normal; c = ink; }`;
  const PIXEL = `#version 300 es
    precision highp float; in vec3 n; in vec4 c; out vec4 pixel;
    void main() {
      vec3 u = normalize(n); if (u.z < 0.0) u = -u;
      float light = 0.42 + 0.5 * max(dot(u, normalize(vec3(-0.4, 0.6, 0.7))), 0.0);
      float gleam = 0.22 * pow(max(dot(u, normalize(vec3(-0.22, 0.33, 0.95))), 0.0), 40.0);
      pixel = vec4(c.rgb * light + gleam, 1.0) * c.a;
    }`;

  // Triangles under construction: position, normal, colour.
  class Mesh {
    constructor() { this.numbers = []; }
    point(p, n, ink) { this.numbers.push(...p, ...n, ...ink); }
    ellipsoid(centre, axes, ink, wide = 64, high = 40) {
      const squares = axes.map(a => dot(a, a) || 1e-12);
      const at = (i, j) => {
        const lat = Math.PI * (j / high - 0.5), lon = 2 * Math.PI * i / wide;
        const s = [Math.cos(lat) * Math.cos(lon), Math.cos(lat) * Math.sin(lon), Math.sin(lat)];
        const p = axes.reduce((sum, a, k) => add(sum, a, s[k]), centre);
        return [p, unit(axes.reduce((sum, a, k) => add(sum, a, s[k] / squares[k]), [0, 0, 0]))];
      };
      for (let j = 0; j < high; j++) for (let i = 0; i < wide; i++) {
        const corners = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        for (const k of [0, 1, 2, 0, 2, 3]) this.point(...corners[k], ink);
      }
    }
    box(centre, axes, ink) {
      for (const [a, b, c] of [0, 1, 2].map(k => [axes[k], axes[(k + 1) % 3], axes[(k + 2) % 3]])) for (const s of [1, -1]) {
        const face = add(centre, a, s), n = unit([0, 1, 2].map(i => s * a[i]));
        for (const [u, v] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) this.point(add(add(face, b, u), c, v), n, ink);
      }
    }
    tube(points, radius, inks) {
      let before = null;
      points.forEach((p, i) => {
        if (!p) { before = null; return; }
        const next = points[i + 1] || p, last = (before && points[i - 1]) || p;
        const along = unit(add(next, last, -1)), [u, v] = sideways(along);
        const ring = Array.from({ length: TUBE + 1 }, (_, k) => {
          const a = 2 * Math.PI * k / TUBE, n = add([0, 0, 0].map((_, c) => u[c] * Math.cos(a)), v, Math.sin(a));
          return [add(p, n, radius), n];
        });
        if (before) for (let k = 0; k < TUBE; k++) {
          for (const [from, at] of [[before, k], [before, k + 1], [ring, k + 1], [before, k], [ring, k + 1], [ring, k]]) {
            this.point(...from[at], from === ring ? inks(i) : inks(i - 1));
          }
        }
        before = ring;
      });
    }
    arrow(from, to, radius, ink) {
      const along = unit(add(to, from, -1)), foot = add(to, along, -6 * radius), [u, v] = sideways(along);
      this.tube([from, foot], radius, () => ink);
      for (let k = 0; k < 16; k++) {
        const rim = k => { const a = 2 * Math.PI * k / 16; return add([0, 0, 0].map((_, c) => u[c] * Math.cos(a)), v, Math.sin(a)); };
        for (const [p, n] of [[add(foot, rim(k), 2.6 * radius), rim(k)], [add(foot, rim(k + 1), 2.6 * radius), rim(k + 1)], [to, along]]) this.point(p, n, ink);
      }
    }
    ball(p, radius, ink) { this.ellipsoid(p, [[radius, 0, 0], [0, radius, 0], [0, 0, radius]], ink, 16, 10); }
    disc(centre, normal, radius, ink) {
      const [u, v] = sideways(normal), rim = k => { const a = Math.PI * k / 32; return add(add(centre, u, radius * Math.cos(a)), v, radius * Math.sin(a)); };
      for (let k = 0; k < 64; k++) for (const p of [centre, rim(k), rim(k + 1)]) this.point(p, normal, ink);
    }
  }

  // Turn and shift of every body since the first time: joints one after the other, from the root outwards.
  function posed(tree, k, own, ...beside) {
    const moves = tree && tree.base_q_xyzw.length;
    const all = [moves ? { q: tree.base_q_xyzw[k], p: tree.base_shift[k] } : own, ...beside];
    for (const j of tree ? tree.joints : []) {
      const at = all[j.parent] || all[0], by = j.moved[k] || 0;
      const q = j.slides ? STILL : about(j.axis, by);
      const p = j.slides ? add([0, 0, 0], j.axis, by) : add(j.origin, turn(q, j.origin), -1);
      all[j.child] = { q: times(at.q, q), p: add(at.p, turn(at.q, p)) };
    }
    return all;
  }
  // Half the size of a scene in which no body leaves the picture while joints move.
  function roomy({ tree, ellipsoids, centre, extent }) {
    const ends = ellipsoids.flatMap(e => e.axes.flatMap(a => [1, -1].map(s => [e.body, add(e.centre, a, s)])));
    const far = all => ends.map(([body, x]) => 0.6 * Math.hypot(...add(add(all[body].p, turn(all[body].q, x)), centre, -1)));
    const farthest = (most, _, k) => Math.max(most, ...far(posed(tree, k, { q: STILL, p: [0, 0, 0] })));
    return tree ? tree.time_s.reduce(farthest, extent) : extent;
  }

  class Picture {
    constructor(figure) {
      this.figure = figure;
      this.data = Picture.together(JSON.parse(figure.querySelector(".scene-data").textContent));
      this.canvas = document.createElement("canvas");
      const gl = this.gl = this.canvas.getContext("webgl2", { antialias: true, premultipliedAlpha: true, preserveDrawingBuffer: true });
      if (!gl || !this.program()) return;
      this.roll = this.data.rolling;
      // Low over the invariable plane, so that the point of contact is seen.
      this.yaw = -0.9; this.pitch = this.roll && this.roll.free ? 0.18 : 0.42; this.zoom = 1; this.view = this.roll && this.roll.free ? "space" : "body";
      this.timed = this.roll || this.data.tree;
      this.extent = this.data.extent; this.centre = this.data.centre; this.apart = this.data.beside ? 1.2 * this.extent : 0;
      const q = matchMedia("(prefers-reduced-motion: reduce)");
      this.idle = !q.matches;
      const defined = this.roll ? this.roll.pole.map((p, k) => p ? k : -1).filter(k => k >= 0) : [];
      this.frame = defined[defined.length >> 1] || 0;
      figure.classList.add("live");
      const stage = figure.querySelector(".stage");
      stage.appendChild(this.canvas);
      this.words = document.createElement("div");
      this.words.className = "words";
      stage.appendChild(this.words);
      this.canvas.tabIndex = 0;
      this.canvas.setAttribute("role", "img");
      this.canvas.setAttribute("aria-label", figure.querySelector(".still").getAttribute("aria-label") + "; arrow keys turn it, plus and minus zoom");
      this.controls(stage);
      this.listen();
      matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { this.solid = null; this.draw(); });
      new IntersectionObserver(seen => { this.seen = seen[0].isIntersecting; this.wake(); }).observe(this.canvas);
      this.ready = true;
      this.draw();
    }
    // The bodies of the scene beside follow the one body of the scene, at the same size.
    static together(d) {
      const b = d.beside, f = b && d.extent / roomy(b), at = p => p && p.map((x, k) => d.centre[k] + f * (x - b.centre[k]));
      if (!b) return d;
      const next = item => ({ ...item, body: item.body + 1 });
      d.ellipsoids.push(...b.ellipsoids.map(e => ({ ...next(e), centre: at(e.centre), axes: e.axes.map(a => a.map(x => f * x)) })));
      d.curves.push(...b.curves.map(c => ({ ...next(c), points: c.points.map(at) })));
      d.arrows.push(...b.arrows.map(a => ({ ...next(a), from: at(a.from), to: at(a.to) })));
      d.spots.push(...b.spots.map(s => ({ ...next(s), at: at(s.at) })));
      const hinge = j => ({ ...j, parent: j.parent + 1, child: j.child + 1, origin: at(j.origin), moved: j.slides ? j.moved.map(x => f * x) : j.moved });
      d.tree = b.tree && { ...b.tree, bodies: b.tree.bodies + 1, joints: b.tree.joints.map(hinge) };
      return d;
    }
    program() {
      const gl = this.gl, p = gl.createProgram();
      for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, PIXEL]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, text.trim()); gl.compileShader(shader); gl.attachShader(p, shader);
      }
      ["at", "normal", "ink"].forEach((name, k) => gl.bindAttribLocation(p, k, name));
      gl.linkProgram(p);
      if (!gl.getProgramParameter(p, gl.LINK_STATUS)) return false;
      gl.useProgram(p);
      this.place = gl.getUniformLocation(p, "place"); this.turned = gl.getUniformLocation(p, "turned");
      gl.enable(gl.DEPTH_TEST); gl.enable(gl.BLEND); gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
      return true;
    }
    colour(k, alpha = 1) {
      const hex = getComputedStyle(document.documentElement).getPropertyValue("--c" + k).trim();
      return [1, 3, 5].map(i => parseInt(hex.slice(i, i + 2), 16) / 255).concat(alpha);
    }
    controls(stage) {
      const bar = document.createElement("div");
      bar.className = "controls";
      const button = (text, act, pressed) => {
        const b = document.createElement("button");
        b.type = "button"; b.textContent = text;
        if (pressed !== undefined) b.setAttribute("aria-pressed", pressed);
        b.addEventListener("click", () => { this.stop(); act(b); this.draw(); });
        bar.appendChild(b);
        return b;
      };
      if (this.roll) {
        const views = ["body", "space", "along h"].map(name => button(name, b => {
          this.view = name;
          for (const o of views) o.setAttribute("aria-pressed", o === b);
          // Space has h downwards.
          if (name === "along h") { this.pitch = -Math.PI / 2; }
          else if (this.pitch < -1.5) { this.pitch = 0.42; }
        }, name === this.view));
      }
      if (this.timed) {
        button("play", b => this.play(b));
        this.slider = document.createElement("input");
        Object.assign(this.slider, { type: "range", min: 0, max: this.timed.time_s.length - 1, value: this.frame });
        this.slider.setAttribute("aria-label", "time");
        this.slider.addEventListener("input", () => { this.stop(); this.show(+this.slider.value, true); });
        bar.appendChild(this.slider);
        this.clock = document.createElement("output");
        bar.appendChild(this.clock);
        document.addEventListener("poinsot:time", e => { if (e.detail.from !== this && e.detail.group === this.timed.group) this.show(this.nearest(e.detail.time), false); });
      }
      button("reset", () => { this.yaw = -0.9; this.pitch = 0.42; this.zoom = 1; });
      stage.after(bar);
    }
    nearest(t) {
      const all = this.timed.time_s;
      let low = 0, high = all.length - 1;
      while (high - low > 1) { const middle = (low + high) >> 1; if (all[middle] > t) high = middle; else low = middle; }
      return t - all[low] <= all[high] - t ? low : high;
    }
    show(frame, tell) {
      this.frame = frame;
      if (this.slider) this.slider.value = frame;
      if (tell) document.dispatchEvent(new CustomEvent("poinsot:time", { detail: { group: this.timed.group, time: this.timed.time_s[frame], from: this } }));
      this.soon();
    }
    // Several curves may tell one time: one picture a frame of the screen.
    soon() {
      if (this.waiting) return;
      this.waiting = true;
      requestAnimationFrame(() => { this.waiting = false; this.draw(); });
    }
    listen() {
      const c = this.canvas, held = new Map();
      c.addEventListener("pointerdown", e => { this.stop(); held.set(e.pointerId, [e.clientX, e.clientY]); c.setPointerCapture(e.pointerId); });
      c.addEventListener("pointermove", e => {
        const from = held.get(e.pointerId);
        if (!from) return;
        const other = [...held].find(h => h[0] !== e.pointerId);
        if (other) {
          const gap = p => Math.hypot(p[0] - other[1][0], p[1] - other[1][1]);
          this.zoomed(gap([e.clientX, e.clientY]) / Math.max(gap(from), 1));
        } else this.rotate(-(e.clientX - from[0]) * 0.008, (e.clientY - from[1]) * 0.008);
        held.set(e.pointerId, [e.clientX, e.clientY]);
      });
      for (const end of ["pointerup", "pointercancel"]) c.addEventListener(end, e => held.delete(e.pointerId));
      c.addEventListener("keydown", e => {
        const act = { ArrowLeft: () => this.rotate(0.1, 0), ArrowRight: () => this.rotate(-0.1, 0), ArrowUp: () => this.rotate(0, 0.1),
          ArrowDown: () => this.rotate(0, -0.1), "+": () => this.zoomed(1.2), "-": () => this.zoomed(1 / 1.2) }[e.key];
        if (act) { e.preventDefault(); this.stop(); act(); }
      });
      addEventListener("resize", () => this.draw());
      document.addEventListener("poinsot:shown", () => this.draw());
    }
    stop() { this.idle = false; this.playing = false; if (this.player) this.player.textContent = "play"; }
    zoomed(by) { this.zoom = Math.max(0.4, Math.min(6, this.zoom * by)); this.draw(); }
    rotate(yaw, pitch) { this.yaw += yaw; this.pitch = Math.max(-1.57, Math.min(1.57, this.pitch + pitch)); this.draw(); }
    play(button) {
      this.player = button;
      this.playing = button.textContent === "play";
      button.textContent = this.playing ? "pause" : "play";
      this.from = this.frame; this.begun = performance.now();
      this.wake();
    }
    wake() {
      if (this.running || !(this.seen && (this.idle || this.playing))) return;
      this.running = true;
      let last = performance.now();
      const step = now => {
        if (!(this.seen && (this.idle || this.playing))) { this.running = false; return; }
        if (this.playing) {
          const n = this.timed.time_s.length;
          this.show((this.from + Math.floor((now - this.begun) / 1000 / SECONDS * n)) % n, true);
        } else {
          this.yaw += SPEED * (now - last) / 1000;
          this.draw();
        }
        last = now;
        requestAnimationFrame(step);
      };
      requestAnimationFrame(step);
    }
    upload(mesh) {
      const gl = this.gl, buffer = gl.createBuffer();
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(mesh.numbers), gl.STATIC_DRAW);
      return { buffer, count: mesh.numbers.length / 10 };
    }
    paint({ buffer, count }, q, offset = [0, 0, 0]) {
      const gl = this.gl, { right, up, towards, sx, sy, depth } = this.eye;
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      [3, 3, 4].forEach((size, k) => { gl.enableVertexAttribArray(k); gl.vertexAttribPointer(k, size, gl.FLOAT, false, 40, [0, 12, 24][k]); });
      const columns = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map(e => turn(q, e));
      const off = add(offset, this.eye.centre, -1);
      const row = (axis, s) => [...columns.map(c => s * dot(axis, c)), s * dot(axis, off)];
      const rows = [row(right, sx), row(up, sy), row(towards, -depth), [0, 0, 0, 1]];
      gl.uniformMatrix4fv(this.place, true, rows.flat());
      gl.uniformMatrix3fv(this.turned, true, [right, up, towards].flatMap(axis => columns.map(c => dot(axis, c))));
      gl.drawArrays(gl.TRIANGLES, 0, count);
    }
    // What does not change with time, made once: per body of the tree, or all in the one body.
    build() {
      const thin = 0.012 * this.extent, d = this.data;
      const tree = d.tree, clear = new Mesh();
      const bodies = Array.from({ length: tree ? tree.bodies : this.apart ? 2 : 1 }, () => new Mesh());
      const of = item => bodies[item.body] || bodies[bodies.length - 1];
      d.ellipsoids.forEach(e => e.faint ? clear.ellipsoid(e.centre, e.axes, this.colour(e.colour, 0.16)) : of(e)[e.boxed ? "box" : "ellipsoid"](e.centre, e.axes, this.colour(e.colour)));
      d.curves.forEach(c => of(c).tube(c.points, (c.shares ? 1.25 : 0.7) * thin, i => c.shares ? [...ramp(c.shares[i]), 1] : this.colour(c.colour)));
      d.arrows.forEach(a => of(a).arrow(a.from, a.to, 0.6 * thin, this.colour(a.colour)));
      d.spots.forEach(s => of(s).ball(s.at, 1.6 * thin, this.colour(s.colour)));
      this.solid = bodies.map(b => this.upload(b)); this.ghost = this.upload(clear);
      if (this.roll && this.roll.free) {
        const low = this.low(), path = new Mesh(), n = this.roll.time_s.length;
        // On the plane: what the motion strays from it, less than a line's width, is not drawn.
        const points = this.roll.pole.map((p, k) => { const s = p && turn(this.roll.q_xyzw[k], p); return s && [s[0], s[1], low]; });
        path.tube(points, 0.8 * thin, i => [...ramp(i / n), 1]);
        this.herpolhode = this.upload(path);
        const plane = new Mesh();
        plane.disc([0, 0, low], [0, 0, 1], 1.3 * this.extent, this.colour(6, 0.3));
        this.plane = this.upload(plane);
      }
    }
    // Turn and shift of every body since the first time.
    poses(own) {
      const beside = this.apart ? [{ q: own, p: add([0, 0, 0], this.eye.right, 2 * this.apart) }] : [];
      return posed(this.data.tree, this.frame, { q: own, p: [0, 0, 0] }, ...beside);
    }
    // Height of the invariable plane, whose normal is the third axis of space.
    low() {
      const all = this.roll.pole.map((p, k) => p && turn(this.roll.q_xyzw[k], p)[2]).filter(z => z !== null && z !== undefined);
      return all.reduce((a, b) => a + b, 0) / Math.max(all.length, 1);
    }
    draw() {
      if (!this.ready) return;
      const gl = this.gl, c = this.canvas, ratio = Math.min(devicePixelRatio || 1, 2), wide = c.clientWidth, high = c.clientHeight;
      if (!wide || !high) return;
      if (!this.solid) this.build();
      if (c.width !== Math.round(wide * ratio) || c.height !== Math.round(high * ratio)) { c.width = Math.round(wide * ratio); c.height = Math.round(high * ratio); }
      gl.viewport(0, 0, c.width, c.height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      const roll = this.roll, k = this.frame, thin = 0.012 * this.extent;
      const q = roll ? roll.q_xyzw[k] : STILL, space = roll && this.view !== "body";
      const own = space ? q : STILL, back = space ? STILL : [-q[0], -q[1], -q[2], q[3]];
      const [sy, cy, sp, cp] = [Math.sin(this.yaw), Math.cos(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch)];
      const right = [-sy, cy, 0], apart = this.apart;
      const size = this.zoom * 0.78 * Math.min(1, wide / high / (1 + apart / this.extent)) / this.extent;
      this.eye = { centre: add(this.centre, right, apart), right, up: [-sp * cy, -sp * sy, cp], towards: [cp * cy, cp * sy, sp], sx: size * high / wide, sy: size, depth: 0.2 / this.extent };
      const poses = this.poses(own), pose = body => poses[body] || poses[poses.length - 1];
      this.solid.forEach((mesh, b) => this.paint(mesh, pose(b).q, pose(b).p));
      const placed = (item, x) => { const at = pose(item.body); return add(at.p, turn(at.q, x)); };
      const labels = this.data.spots.map(s => [s.label, placed(s, s.at)]).concat(this.data.arrows.map(a => [a.label, placed(a, a.to)]));
      if (roll && roll.pole[k]) {
        const now = new Mesh(), pole = roll.pole[k], h = roll.normal[k];
        now.ball(pole, 2.4 * thin, this.colour(1));
        now.arrow([0, 0, 0], add([0, 0, 0], pole, 1.25), 0.8 * thin, this.colour(1));
        now.arrow([0, 0, 0], add([0, 0, 0], h, 1.05 * this.extent), 0.8 * thin, this.colour(2));
        this.passing(now, own);
        labels.push(["\u03c9", turn(own, add([0, 0, 0], pole, 1.25))], ["h", turn(own, add([0, 0, 0], h, 1.05 * this.extent))]);
        if (!roll.free) {
          const tangent = new Mesh();
          tangent.disc(pole, h, 0.7 * this.extent, this.colour(6, 0.3));
          gl.depthMask(false); this.passing(tangent, own); gl.depthMask(true);
        }
      }
      if (this.herpolhode) {
        this.paint(this.herpolhode, back);
        gl.depthMask(false); this.paint(this.plane, back); gl.depthMask(true);
      }
      gl.depthMask(false); this.paint(this.ghost, own); gl.depthMask(true);
      this.label(labels, wide, high);
      if (this.clock) {
        this.clock.textContent = "t = " + +this.timed.time_s[k].toPrecision(6) + " s" + (!roll || roll.pole[k] ? "" : ", nearly at rest");
        this.slider.setAttribute("aria-valuetext", this.clock.textContent);
      }
    }
    passing(mesh, q) { const made = this.upload(mesh); this.paint(made, q); this.gl.deleteBuffer(made.buffer); }
    label(list, wide, high) {
      const { centre, right, up, sx, sy } = this.eye, taken = [];
      const placed = ([word, at], p = add(at, centre, -1)) => [word, wide * (0.5 + 0.5 * sx * dot(p, right)), high * (0.5 - 0.5 * sy * dot(p, up))];
      const shown = list.filter(l => l[0]).map(l => placed(l)).sort((a, b) => a[2] - b[2]);
      while (this.words.children.length < shown.length) this.words.appendChild(document.createElement("span"));
      [...this.words.children].forEach((span, i) => {
        span.hidden = i >= shown.length;
        if (span.hidden) return;
        const [word, x, y] = shown[i];
        span.textContent = word;
        // Inside the picture, and below a label that stands there.
        const left = Math.min(x + 6, wide - span.offsetWidth), end = left + span.offsetWidth;
        const top = taken.reduce((top, t) => top < t[2] + 16 && left < t[1] && end > t[0] ? t[2] + 16 : top, y - 20);
        taken.push([left, end, top]);
        span.style.transform = `translate(${left}px, ${top}px)`;
      });
    }
  }
  // Made when they come near the screen: the page opens without them.
  const near = new IntersectionObserver(seen => {
    for (const s of seen) if (s.isIntersecting) { near.unobserve(s.target); new Picture(s.target); }
  }, { rootMargin: "200px" });
  for (const figure of document.querySelectorAll("figure.scene")) near.observe(figure);
})();
