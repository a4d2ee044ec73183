// SPDX-License-Identifier: MIT
// A plan of the room, from above or from the side, whose parts can be dragged.
"use strict";

const PLAN_TOP = 511;
const GRIP = 9;            // radius of a handle, in world units
const LOOK_LENGTH = 70;    // from the camera to the handle of its direction
const SIDES = { above: { across: 1, up: 0, name: "from above" }, side: { across: 0, up: 2, name: "from the side" } };
const AXES = ["x", "y", "z"];

// The walker is where the camera stands now; `copyCamera` writes it into the room's text.
class Plan {
  constructor(svg, side, room, { walker, copyCamera }) {
    Object.assign(this, { svg, room, walker, copyCamera, ...SIDES[side] });
    this.depth = 3 - this.across - this.up;
    for (const kind of ["pointerdown", "pointermove", "pointerup", "pointercancel"]) {
      svg.addEventListener(kind, (event) => this[kind](event));
    }
  }

  // Map world coordinates to the plan, and back.
  at(point) {
    return [point[this.across], PLAN_TOP - point[this.up]];
  }

  under(event) {
    const matrix = this.svg.getScreenCTM().inverse();
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
    return [x, PLAN_TOP - y];
  }

  snapped(value) {
    const grid = Number(find("room-grid").value);
    return Math.max(0, Math.min(PLAN_TOP, value >= PLAN_TOP - grid / 2 ? PLAN_TOP : Math.round(value / grid) * grid));
  }

  pointerdown(event) {
    const target = event.target.closest("[data-grip]");
    if (!target || event.button) return;
    const [kind, ...numbers] = target.dataset.grip.split(" ");
    if (numbers.length) this.room.select(Number(numbers[0]));
    this.room.keep();
    if (kind === "camera" || kind === "look") this.copyCamera();
    const { scene } = this.room;
    this.held = { kind, numbers: numbers.map(Number), from: this.under(event), scene: structuredClone(scene) };
    this.svg.setPointerCapture(event.pointerId);
    event.preventDefault();
  }

  pointermove(event) {
    if (!this.held) return;
    this[`drag_${this.held.kind}`](this.under(event));
  }

  pointerup() {
    if (this.held && this.room.before.at(-1) === this.room.text) this.room.before.pop();
    this.held = null;
    this.room.dispatchEvent(new Event("settled"));
  }

  pointercancel() {
    this.pointerup();
  }

  moved(point, under) {
    const result = [...point], { from } = this.held;
    [this.across, this.up].forEach((axis, way) => (result[axis] = this.snapped(point[axis] + under[way] - from[way])));
    return result;
  }

  // Move the whole rectangle, and keep its size.
  drag_body(under) {
    const [index] = this.held.numbers, { corners } = this.held.scene.rect[index], { from } = this.held;
    const result = corners.map((corner) => [...corner]);
    [this.across, this.up].forEach((axis, way) => {
      const low = Math.min(corners[0][axis], corners[1][axis]), high = Math.max(corners[0][axis], corners[1][axis]);
      const delta = Math.max(-low, Math.min(PLAN_TOP - high, this.snapped(low + under[way] - from[way]) - low));
      for (const corner of result) corner[axis] += delta;
    });
    this.room.set("rect", index, "corners", result);
  }

  // Move a corner, or an edge if one of the two is -1: numbers of the corner that has the coordinate across, and up.
  drag_corner(under) {
    const [index, ...ends] = this.held.numbers, { corners } = this.held.scene.rect[index], { from } = this.held;
    const result = corners.map((corner) => [...corner]);
    [this.across, this.up].forEach((axis, way) => {
      if (ends[way] < 0) return;
      const place = this.snapped(corners[ends[way]][axis] + under[way] - from[way]);
      const isPlane = axis === this.planeOf(corners);
      for (const end of isPlane ? [0, 1] : [ends[way]]) result[end][axis] = place;
    });
    this.room.set("rect", index, "corners", result);
  }

  planeOf([first, second]) {
    return [0, 1, 2].find((axis) => first[axis] === second[axis]);
  }

  drag_camera(under) {
    const position = this.moved(this.held.scene.camera.position, under);
    this.room.set("camera", 0, "position", position);
  }

  drag_look([across, up]) {
    const { position, yaw } = this.held.scene.camera;
    const [right, above] = [across - position[this.across], up - position[this.up]];
    const degrees = (value) => Math.round((value * 180) / Math.PI);
    if (this.depth === 2) this.room.set("camera", 0, "yaw", degrees(Math.atan2(right, above)));
    else {
      const flat = Math.max(1, Math.abs(right) / Math.max(0.2, Math.abs(Math.cos((yaw * Math.PI) / 180))));
      const { steepest } = RayCaster.walk;
      this.room.set("camera", 0, "pitch", Math.max(-steepest, Math.min(steepest, degrees(Math.atan2(above, flat)))));
    }
  }

  drag_light(under) {
    this.room.set("light", 0, "position", this.moved(this.held.scene.light.position, under));
  }

  circle(point, attributes, title) {
    const [cx, cy] = this.at(point);
    return drawn("circle", { cx, cy, ...attributes }, title);
  }

  rectangle({ corners: [first, second], colour, name }, index) {
    const [x1, y1] = this.at(first), [x2, y2] = this.at(second);
    const label = `${index} ${name ?? ""}`.trim(), grip = `body ${index}`, fill = hex(rgb(colour));
    const chosen = index === this.room.selected ? " chosen" : "";
    if (x1 !== x2 && y1 !== y2) {
      const [x, y] = [Math.min(x1, x2), Math.min(y1, y2)];
      const size = { x, y, width: Math.abs(x2 - x1), height: Math.abs(y2 - y1) };
      return [drawn("rect", { ...size, fill, class: `area${chosen}`, "data-grip": grip }, label)];
    }
    const line = { x1, y1, x2, y2 };
    return [
      drawn("line", { ...line, stroke: fill, class: `wall${chosen}` }),
      drawn("line", { ...line, class: "grip", "data-grip": grip }, label),
    ];
  }

  handles({ corners }, index) {
    const [first, second] = corners;
    const ends = (axis) => (first[axis] === second[axis] ? [0] : [0, 1]);
    const made = [];
    const place = (a, b) => this.at(Object.assign([0, 0, 0], {
      [this.across]: corners[a][this.across], [this.up]: corners[b][this.up],
    }));
    const isArea = ends(this.across).length + ends(this.up).length === 4;
    if (isArea) {
      for (const end of [0, 1]) {
        const [[x1, y1], [x2, y2]] = [place(end, 0), place(end, 1)];
        made.push(drawn("line", { x1, y1, x2, y2, class: "grip", "data-grip": `corner ${index} ${end} -1` }));
        const [[x3, y3], [x4, y4]] = [place(0, end), place(1, end)];
        made.push(drawn("line", { x1: x3, y1: y3, x2: x4, y2: y4, class: "grip", "data-grip": `corner ${index} -1 ${end}` }));
      }
    }
    for (const a of ends(this.across)) {
      for (const b of ends(this.up)) {
        const [cx, cy] = place(a, b);
        // At the end of a wall only the coordinate along the wall moves.
        const along = isArea ? [a, b] : ends(this.across).length === 2 ? [a, -1] : [-1, b];
        made.push(drawn("circle", { cx, cy, r: GRIP, class: "handle", "data-grip": `corner ${index} ${along.join(" ")}` }));
      }
    }
    return made;
  }

  draw() {
    const { scene, selected } = this.room, walker = this.walker();
    if (!scene) return;
    // The smaller ones lie on the larger ones, and lines on all.
    const size = ({ corners: [a, b] }) => Math.abs((a[this.across] - b[this.across]) * (a[this.up] - b[this.up]));
    const order = scene.rect.map((rect, index) => ({ rect, index }))
      .sort((a, b) => (a.index === selected) - (b.index === selected) || size(b.rect) - size(a.rect));
    const frame = drawn("rect", { x: 0, y: 0, width: PLAN_TOP, height: PLAN_TOP, class: "world" });
    const label = (x, y, text) => {
      const made = drawn("text", { x, y });
      made.textContent = text;
      return made;
    };
    const here = walker?.place ?? scene.camera.position;
    const yaw = ((walker?.yaw ?? 0) * Math.PI) / 180, pitch = ((walker?.pitch ?? 0) * Math.PI) / 180;
    const ahead = [Math.cos(yaw) * Math.cos(pitch), Math.sin(yaw) * Math.cos(pitch), Math.sin(pitch)];
    const tip = here.map((coordinate, axis) => coordinate + LOOK_LENGTH * ahead[axis]);
    const [[x1, y1], [x2, y2]] = [here, tip].map((point) => this.at(point));
    this.svg.replaceChildren(
      frame,
      ...order.flatMap(({ rect, index }) => this.rectangle(rect, index)),
      ...(this.room.rect ? this.handles(this.room.rect, selected) : []),
      drawn("line", { x1, y1, x2, y2, class: "ray" }),
      this.circle(tip, { r: GRIP, class: "handle", "data-grip": "look" }, "the camera's direction"),
      this.circle(here, { r: GRIP + 2, class: "camera", "data-grip": "camera" }, "the camera"),
      ...(scene.light ? [this.circle(scene.light.position, { r: GRIP + 2, class: "light", "data-grip": "light" }, "the light")] : []),
      label(PLAN_TOP - 12, PLAN_TOP + 16, AXES[this.across]), label(-16, 14, AXES[this.up]), label(-16, PLAN_TOP + 16, "0"),
    );
  }
}
