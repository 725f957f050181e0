// The 3D view of report.html: clouds, stations and links of one part of the survey. It speaks with the rest of the page
// through window.isthmus (select, listeners), so that what is picked in one place is marked in all.
import { Color, PerspectiveCamera, Scene, Vector3, WebGLRenderer, BufferGeometry, BufferAttribute, Points, PointsMaterial, CanvasTexture } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { cloudOf } from "./clouds.js";

const box = document.getElementById("view");
const data = JSON.parse(document.getElementById("view-data").textContent);
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const control = name => box.querySelector(`[data-view=${name}]`);
const MOVING_POINTS = 150000;  // drawn while the camera moves: what a processor without graphics card keeps up with

const discTexture = () => {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const c = canvas.getContext("2d");
  c.fillStyle = "#fff";
  c.beginPath();
  c.arc(32, 32, 29, 0, 2 * Math.PI);
  c.fill();
  return new CanvasTexture(canvas);
};

class View {
  constructor() {
    this.canvas = box.querySelector("canvas");
    this.renderer = new WebGLRenderer({ canvas: this.canvas, antialias: false, preserveDrawingBuffer: true });
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(50, 1, 0.05, 5000);
    this.orbit = new OrbitControls(this.camera, this.canvas);
    this.orbit.enableDamping = false;
    this.orbit.zoomToCursor = true;
    this.up = new Vector3(0, 0, 1);
    this.shared = {
      up: { value: this.up }, faint: { value: new Color() }, heights: { value: { x: 0, y: 1 } }, cut: { value: 1e9 },
      size: { value: 1.3 }, pixels: { value: 600 }, voxel: { value: data.voxel }, mode: { value: 0 },
    };
    this.moving = false;
    this.hovered = undefined;
    this.disc = discTexture();
    this.part = data.parts[0].number;
    this.listen();
    this.load();
    this.theme();
    this.resize();
    this.home();
    this.restyle();
    box.dataset.ready = "true";
  }

  get stations() { return data.stations.filter(s => s.part === this.part); }

  load() {
    this.scene.clear();
    this.up.fromArray(data.parts.find(p => p.number === this.part).up);
    this.camera.up.copy(this.up);
    this.orbit._quat?.setFromUnitVectors(this.up, new Vector3(0, 1, 0));
    this.orbit._quatInverse?.copy(this.orbit._quat).invert();
    this.clouds = new Map();
    this.place = new Map(this.stations.map(s => [s.id, new Vector3().fromArray(s.at)]));
    for (const station of this.stations) {
      if (!station.points) continue;
      const cloud = cloudOf(station, this.shared);
      this.clouds.set(station.id, cloud);
      this.scene.add(cloud);
    }
    this.measure();
    this.links = data.links.filter(l => this.place.has(l.source) && this.place.has(l.target) && l.verdict === "accepted");
    this.lines = this.linesOf(2);
    this.scene.add(this.lines);
    this.chosen = this.linesOf(6);
    this.scene.add(this.chosen);
    const positions = new Float32Array(this.stations.flatMap(s => s.at));
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("color", new BufferAttribute(new Float32Array(positions.length), 3));
    this.dots = new Points(geometry, new PointsMaterial({ size: 13, sizeAttenuation: false, vertexColors: true, map: this.disc, alphaTest: 0.5,
      transparent: true, depthTest: false }));
    this.dots.renderOrder = 3;
    this.dots.frustumCulled = false;
    this.scene.add(this.dots);
    const cut = control("cut");
    cut.value = cut.max;
    this.applyCut();
  }

  linesOf(width) {
    const lines = new LineSegments2(new LineSegmentsGeometry(), new LineMaterial({ linewidth: width, vertexColors: true, depthTest: false, transparent: true }));
    lines.renderOrder = 2;
    lines.frustumCulled = false;
    return lines;
  }

  /// Heights that hold the middle 98 % of the points, and the room they fill.
  measure() {
    const heights = [], values = [[], [], []];
    for (const cloud of this.clouds.values()) {
      const p = cloud.geometry.attributes.position.array, s = cloud.scale.x, o = cloud.position;
      const step = Math.max(1, Math.floor(cloud.userData.count / 500));
      for (let k = 0; k < cloud.userData.count; k += step) {
        const v = new Vector3(o.x + s * p[3 * k], o.y + s * p[3 * k + 1], o.z + s * p[3 * k + 2]);
        heights.push(v.dot(this.up));
        v.toArray().forEach((x, i) => values[i].push(x));
      }
    }
    for (const at of this.place.values()) { heights.push(at.dot(this.up)); at.toArray().forEach((x, i) => values[i].push(x)); }
    const between = (list, share) => { list.sort((a, b) => a - b); return list[Math.min(list.length - 1, Math.floor(share * list.length))]; };
    this.shared.heights.value = { x: between(heights, 0.01), y: between(heights, 0.99) };
    this.floor = heights[0];
    this.roof = heights[heights.length - 1];
    // What is seen through windows and gaps lies far off in a few points, and would make the survey small.
    const low = new Vector3(...values.map(v => between(v, 0.1))), high = new Vector3(...values.map(v => between(v, 0.9)));
    const beyond = high.clone().sub(low).multiplyScalar(0.125);
    this.low = low.sub(beyond);
    this.high = high.add(beyond);
    for (const at of this.place.values()) { this.low.min(at); this.high.max(at); }
    this.reach = Math.max(this.low.distanceTo(this.high), 4 * data.voxel);
  }

  theme() {
    this.scene.background = new Color(css("--sea"));
    this.shared.faint.value = new Color(css("--sea")).lerp(new Color(css("--quiet")), 0.28);
    this.restyle();
  }

  /// Colours of everything, by what is selected and by what the colour means.
  restyle() {
    if (!this.dots) return;
    const picked = window.isthmus.selected;
    const ends = picked.link !== undefined ? picked.link.split("-").map(Number) : picked.scan !== undefined ? [Number(picked.scan)] : [];
    const here = ends.some(id => this.clouds.has(id) || this.place.has(id));
    this.shared.mode.value = { station: 0, height: 1, intensity: 2, error: 0 }[control("colour").value];
    const alone = control("alone").checked;
    for (const [id, cloud] of this.clouds) {
      const mine = ends.indexOf(id);
      const of_pair = here && picked.link !== undefined && mine >= 0;
      cloud.material.uniforms.own.value = of_pair ? new Color(mine === 0 ? css("--pair-a") : css("--pair-b")) : this.colourOf(cloud.userData.station);
      cloud.material.uniforms.dim.value = here && mine < 0 ? 0.9 : 0;
      cloud.visible = !(here && alone && mine < 0);
      if (of_pair) this.shared.mode.value = 0;
    }
    const colours = this.dots.geometry.attributes.color;
    this.stations.forEach((s, k) => new Color(ends.includes(s.id) ? css("--pick") : css("--ink")).toArray(colours.array, 3 * k));
    colours.needsUpdate = true;
    this.lines.visible = control("links").checked;
    const set = (lines, list, colour) => {
      lines.visible = lines.visible && list.length > 0;
      if (list.length === 0) return;
      const positions = [], shades = [];
      for (const l of list) {
        positions.push(...this.place.get(l.source).toArray(), ...this.place.get(l.target).toArray());
        const c = colour(l).toArray();
        shades.push(...c, ...c);
      }
      lines.geometry.dispose();
      lines.geometry = new LineSegmentsGeometry();
      lines.geometry.setPositions(positions);
      lines.geometry.setColors(shades);
    };
    set(this.lines, this.links, l => new Color(css(`--c${l.grade}`)));
    this.chosen.visible = true;
    const shown = data.links.filter(l => this.place.has(l.source) && this.place.has(l.target));
    set(this.chosen, picked.link !== undefined ? shown.filter(l => l.id === picked.link) :
      picked.scan !== undefined ? this.links.filter(l => ends.includes(l.source) || ends.includes(l.target)) : [], () => new Color(css("--pick")));
    this.legend();
    this.draw();
  }

  colourOf(station) {
    if (control("colour").value === "error") {
      if (station.error === null) return new Color(css("--quiet"));
      return new Color(css(`--c${station.grade}`));
    }
    const colour = new Color();
    colour.setHSL((station.id * 0.61803) % 1, 0.5, matchMedia("(prefers-color-scheme: dark)").matches ? 0.66 : 0.5);
    return colour;
  }

  legend() {
    const metres = m => (Math.abs(m) < 0.3 ? `${(1000 * m).toFixed(0)} mm` : `${m.toFixed(1)} m`);
    const picked = window.isthmus.selected;
    const name = id => { const s = data.stations.find(t => t.id === Number(id)); return s ? s.name : id; };
    let text = "";
    if (picked.link !== undefined) {
      const link = data.links.find(l => l.id === picked.link);
      const [a, b] = picked.link.split("-");
      const together = this.place.has(Number(a)) && this.place.has(Number(b));
      text = together ? `<i style="background:var(--pair-a)"></i>${name(a)} <i style="background:var(--pair-b)"></i>${name(b)}${link ? ` \u2013 ${link.verdict}, residual ${link.rms === null ? "\u2013" : metres(link.rms)}` : ""}`
        : "The two scans of this link are not in this part.";
    } else if (picked.scan !== undefined) {
      text = `<i style="background:var(--pick)"></i>${name(picked.scan)}`;
    } else if (control("colour").value === "height") {
      text = `<i class="ramp"></i>height over the anchor: ${metres(this.shared.heights.value.x)} to ${metres(this.shared.heights.value.y)}`;
    } else if (control("colour").value === "error") {
      text = data.errors.map((bound, k) => `<i style="background:var(--c${k})"></i>${bound}`).join(" ") + " \u2013 links of the station off the solved poses, median";
    } else if (control("colour").value === "intensity" && !this.stations.some(s => s.intensity)) {
      text = "The scans hold no intensity.";
    } else if (this.hovered !== undefined) {
      text = name(this.hovered);
    }
    box.querySelector(".view-legend").innerHTML = text || "Drag to turn, wheel to zoom, right button or two fingers to shift; click a station or a link.";
  }

  home() {
    const ahead = new Vector3(0.35, -0.8, 0).addScaledVector(this.up, -new Vector3(0.35, -0.8, 0).dot(this.up)).normalize();
    this.orbit.target.copy(this.low).add(this.high).multiplyScalar(0.5);
    const fit = this.reach * 0.55 / Math.tan(this.camera.fov * Math.PI / 360) / Math.min(1, 0.8 * this.camera.aspect);
    this.camera.position.copy(this.orbit.target).addScaledVector(ahead, 0.5 * fit).addScaledVector(this.up, 0.5 * fit);
    this.settle();
  }

  above() {
    const distance = this.reach * 0.5 / Math.tan(this.camera.fov * Math.PI / 360) / Math.min(1, 0.8 * this.camera.aspect);
    this.orbit.target.copy(this.low).add(this.high).multiplyScalar(0.5);
    this.camera.position.copy(this.orbit.target).addScaledVector(this.up, distance).add(new Vector3(0, -1e-3 * distance, 0));
    this.settle();
  }

  settle() {
    this.camera.near = this.reach * 1e-3;
    this.camera.far = this.reach * 20;
    this.camera.updateProjectionMatrix();
    this.orbit.update();
    this.draw();
  }

  /// Goes to the selected station or link, looking as before.
  go(what) {
    const ids = what.link !== undefined ? what.link.split("-").map(Number) : what.scan !== undefined ? [Number(what.scan)] : [];
    const places = ids.map(id => this.place.get(id)).filter(p => p);
    if (places.length === 0) return;
    const middle = places.reduce((sum, p) => sum.add(p), new Vector3()).multiplyScalar(1 / places.length);
    const radius = Math.max(...ids.map(id => (data.stations.find(s => s.id === id) || {}).radius || 0), places.length > 1 ? places[0].distanceTo(places[1]) : 0, 10 * data.voxel);
    const direction = this.camera.position.clone().sub(this.orbit.target).normalize();
    this.orbit.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(direction, 3.2 * radius);
    this.settle();
  }

  applyCut() {
    const cut = control("cut"), share = Number(cut.value) / Number(cut.max);
    this.shared.cut.value = share >= 1 ? 1e9 : this.floor + share * (this.roof - this.floor);
    this.draw();
  }

  resize() {
    const width = this.canvas.clientWidth || 800, height = this.canvas.clientHeight || 560;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio || 1, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.shared.pixels.value = this.renderer.getPixelRatio() * height / (2 * Math.tan(this.camera.fov * Math.PI / 360));
    this.draw();
  }

  draw() {
    if (this.pending) return;
    this.pending = requestAnimationFrame(() => {
      this.pending = 0;
      this.render();
    });
  }

  render() {
    let total = 0;
    for (const cloud of this.clouds.values()) if (cloud.visible) total += cloud.userData.count;
    const share = this.moving && total > MOVING_POINTS ? MOVING_POINTS / total : 1;
    for (const cloud of this.clouds.values()) {
      const dimmed = cloud.material.uniforms.dim.value > 0;
      cloud.geometry.setDrawRange(0, Math.ceil(cloud.userData.count * share * (dimmed ? 0.35 : 1)));
    }
    const ratio = this.renderer.getPixelRatio();
    this.dots.material.size = (this.place.size > 40 ? 9 : 13) * ratio;
    this.shared.size.value = 1.3 * Math.min(3, Math.sqrt(1 / share)) * data.thinned;
    this.renderer.render(this.scene, this.camera);
    box.dataset.frames = String(Number(box.dataset.frames || 0) + 1);
  }

  /// What lies under the pointer: a station before a link.
  under(event) {
    const r = this.canvas.getBoundingClientRect();
    const px = event.clientX - r.left, py = event.clientY - r.top;
    const onScreen = p => { const q = p.clone().project(this.camera); return { x: (q.x + 1) / 2 * r.width, y: (1 - q.y) / 2 * r.height, ahead: q.z < 1 }; };
    let best = 14, found;
    for (const [id, p] of this.place) {
      const q = onScreen(p), d = Math.hypot(q.x - px, q.y - py);
      if (q.ahead && d < best) { best = d; found = { scan: String(id) }; }
    }
    if (found || !control("links").checked) return found;
    best = 7;
    for (const l of this.links) {
      const a = onScreen(this.place.get(l.source)), b = onScreen(this.place.get(l.target));
      if (!a.ahead || !b.ahead) continue;
      const t = Math.max(0, Math.min(1, ((px - a.x) * (b.x - a.x) + (py - a.y) * (b.y - a.y)) / (Math.hypot(b.x - a.x, b.y - a.y) ** 2 || 1)));
      const d = Math.hypot(a.x + t * (b.x - a.x) - px, a.y + t * (b.y - a.y) - py);
      if (d < best) { best = d; found = { link: l.id }; }
    }
    return found;
  }

  listen() {
    let down;
    this.orbit.addEventListener("start", () => { this.moving = true; });
    this.orbit.addEventListener("change", () => this.draw());
    this.orbit.addEventListener("end", () => { this.moving = false; this.draw(); });
    this.canvas.addEventListener("wheel", () => {
      this.moving = true;
      clearTimeout(this.rest);
      this.rest = setTimeout(() => { this.moving = false; this.draw(); }, 200);
    }, { passive: true });
    this.canvas.addEventListener("pointerdown", e => { down = [e.clientX, e.clientY]; });
    this.canvas.addEventListener("pointerup", e => {
      if (!down || Math.hypot(e.clientX - down[0], e.clientY - down[1]) > 4) return;
      const what = this.under(e);
      if (!what) return;
      window.isthmus.select(what, this.canvas);
    });
    this.canvas.addEventListener("pointermove", e => {
      if (this.moving) return;
      const what = this.under(e), id = what && what.scan !== undefined ? what.scan : undefined;
      this.canvas.style.cursor = what ? "pointer" : "grab";
      if (id !== this.hovered) { this.hovered = id; this.legend(); }
    });
    this.canvas.addEventListener("keydown", e => this.key(e));
    for (const name of ["colour", "links", "alone"]) control(name).addEventListener("change", () => this.restyle());
    control("cut").addEventListener("input", () => this.applyCut());
    control("home").addEventListener("click", () => this.home());
    control("above").addEventListener("click", () => this.above());
    const part = control("part");
    if (part) part.addEventListener("change", () => { this.part = Number(part.value); this.load(); this.restyle(); this.home(); });
    window.isthmus.listeners.push((what, from) => {
      const id = what.link !== undefined ? Number(what.link.split("-")[0]) : Number(what.scan);
      const station = data.stations.find(s => s.id === id);
      if (station && station.part !== this.part && part) { this.part = station.part; part.value = String(this.part); this.load(); this.home(); }
      if (from !== this.canvas) this.go(what);
      this.restyle();
    });
    new ResizeObserver(() => this.resize()).observe(this.canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.theme());
    matchMedia("print").addEventListener("change", () => { this.theme(); this.render(); });
  }

  key(e) {
    const offset = this.camera.position.clone().sub(this.orbit.target);
    const right = new Vector3().crossVectors(this.up, offset).normalize();
    const shift = (axis, sign) => {
      const move = axis.clone().multiplyScalar(sign * 0.08 * offset.length());
      this.camera.position.add(move);
      this.orbit.target.add(move);
    };
    const turn = (axis, angle) => this.camera.position.copy(this.orbit.target).add(offset.applyAxisAngle(axis, angle));
    const tilt = angle => {
      const now = offset.angleTo(this.up);
      turn(right, Math.max(0.01, Math.min(Math.PI - 0.01, now + angle)) - now);
    };
    const ids = this.stations.map(s => s.id), at = ids.indexOf(Number(window.isthmus.selected.scan));
    const step = by => window.isthmus.select({ scan: String(ids[(at + by + ids.length) % ids.length]) });
    const actions = {
      ArrowLeft: () => e.shiftKey ? shift(right, -1) : turn(this.up, -0.12), ArrowRight: () => e.shiftKey ? shift(right, 1) : turn(this.up, 0.12),
      ArrowUp: () => e.shiftKey ? shift(this.up, 1) : tilt(-0.1), ArrowDown: () => e.shiftKey ? shift(this.up, -1) : tilt(0.1),
      "+": () => this.camera.position.copy(this.orbit.target).addScaledVector(offset, 0.85), "-": () => this.camera.position.copy(this.orbit.target).addScaledVector(offset, 1.18),
      Home: () => this.home(), n: () => step(1), p: () => step(at < 0 ? 0 : -1),
    };
    const action = actions[e.key === "=" ? "+" : e.key];
    if (!action) return;
    e.preventDefault();
    action();
    this.orbit.update();
    this.draw();
  }
}

const start = () => {
  try {
    window.isthmus.view = new View();
  } catch (error) {
    box.classList.add("off");
    box.querySelector(".view-legend").textContent = `No 3D view here: ${error.message}`;
  }
};
// The page first: tables and map are there before the clouds are unpacked.
requestAnimationFrame(() => setTimeout(start, 0));
