// SPDX-License-Identifier: MIT
// The tab with a pixel's life: the steps of its ray unit, from the unit's own signals.
"use strict";

const MARK_REACH = 4; // distance of the mark from its pixel, in pixels
const FAR = 2000; // drawn length of a ray that misses, in world units
const DASH = "\u2013";
const SVG = "http://www.w3.org/2000/svg";

const hex = (colour) => `#${colour.toString(16).padStart(6, "0")}`;
const digits = (value) => String(Number(value.toFixed(3)));
const place = (coordinates, denominator) => `(${coordinates.map((one) => digits(one / denominator)).join(", ")})`;

function element(name, content = "", properties = {}) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...[content].flat());
  return made;
}

function drawn(name, attributes, title = "") {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (title) made.append(Object.assign(document.createElementNS(SVG, "title"), { textContent: title }));
  return made;
}

function swatch(colour) {
  const box = element("span", "", { className: "swatch" });
  box.style.background = hex(colour);
  return [box, ` ${hex(colour)}`];
}

// A table; a heading or a cell is text or nodes, or {content, ...properties}.
function table(caption, headings, rows) {
  const cell = (name, given) => {
    const { content = given, ...properties } = given;
    return element(name, content, properties);
  };
  const row = ({ cells, ...properties }) => element("tr", cells.map((given) => cell("td", given)), properties);
  return element("div", element("table", [
    ...(caption ? [element("caption", caption)] : []),
    element("thead", element("tr", headings.map((given) => cell("th", given)))),
    element("tbody", rows.map(row)),
  ]), { className: "scroll" });
}

// Map world coordinates to the plan: x upwards, y to the right.
const above = ([x, y]) => [y, 511 - x];

function drawRectangle({ corners: [first, second], colour }, label) {
  const [[left, top], [right, bottom]] = [first, second].map(above);
  const fill = hex(rgb(colour));
  if (first[2] === second[2] && left !== right && top !== bottom) {
    return drawn("rect", {
      x: Math.min(left, right), y: Math.min(top, bottom), width: Math.abs(right - left),
      height: Math.abs(bottom - top), fill, "fill-opacity": 0.35,
    }, label);
  }
  return drawn("line", { x1: left, y1: top, x2: right, y2: bottom, stroke: fill, class: "wall" }, label);
}

function drawPlan(plan, scene, life, label) {
  const isWall = ({ corners: [first, second] }) => first[2] !== second[2];
  // Floors first: walls stand on them.
  const order = scene.rect.map((rect, index) => ({ rect, index })).sort((a, b) => isWall(a.rect) - isWall(b.rect));
  const points = [scene.camera.position];
  for (const { winner, point, denominator, slope } of life.bounces) {
    const from = points.at(-1);
    const length = Math.max(...slope.map(Math.abs));
    points.push(winner < 0
      ? from.map((start, axis) => start + (FAR * slope[axis]) / length)
      : point.map((coordinate) => coordinate / denominator));
  }
  const hits = life.bounces.flatMap(({ winner }, bounce) => (winner < 0 ? [] : [points[bounce + 1]]));
  const light = scene.light?.position;
  const shadowRays = life.bounces.flatMap(({ winner, shadow }, bounce) => {
    if (!light || winner < 0 || shadow === RayCasterLife.DARK_SIDE) return [];
    const [[x1, y1], [x2, y2]] = [light, points[bounce + 1]].map(above);
    return [drawn("line", { x1, y1, x2, y2, class: "shadow" }, `from the light to hit ${bounce + 1}`)];
  });
  const circle = (point, attributes, title) => {
    const [cx, cy] = above(point);
    return drawn("circle", { cx, cy, ...attributes }, title);
  };
  plan.replaceChildren(
    ...order.map(({ rect, index }) => drawRectangle(rect, label(index))),
    drawn("polyline", { class: "ray", points: points.map((point) => above(point).join()).join(" ") }),
    ...shadowRays,
    ...hits.map((point, number) => circle(point, { class: "hit", r: 6 }, `hit ${number + 1}`)),
    circle(scene.camera.position, { class: "camera", r: 9 }, "the camera"),
    ...(light ? [circle(light, { class: "light", r: 9 }, "the light")] : []),
  );
}

const fractionText = ([numerator, denominator]) =>
  `${numerator}/${denominator} = ${Number((numerator / denominator).toPrecision(4))}`;

// Format a quantity of a tested rectangle; a dash if it is meaningless.
function quantityText({ quantity, scale }, { values, found }, unit) {
  const of = values[quantity];
  if (!of) return "";
  const isInside = values.inside?.[0] === 1;
  if (quantity === "inside") return isInside ? "yes" : "no";
  const means = { t: isInside, depth: isInside, nearest: found, "nearest t": found };
  if (means[quantity] === false) return DASH;
  if (quantity === "t" || quantity === "nearest t") return fractionText(of);
  const isByAxis = values.valid?.length === of.length;
  const texts = of.map((value) => digits(value / (scale ? unit : 1)));
  return texts.map((text, axis) => (isByAxis && !values.valid[axis] ? DASH : text)).join(", ");
}

// Compare the parts of a hit with the golden model: rectangle, t or depth, point, colour; with a light also the shadow
// and the magnitudes of the shadow ray's slope.
function compare(bounce, golden, isExact, light) {
  const parts = ({ winner, distance, point, denominator, colour, fromLight, shadow }) => {
    const lighting = light ? [shadow, fromLight] : [];
    return winner < 0
      ? [-1, null, null, colour, ...lighting.map(() => null)]
      : [winner, distance, [point, denominator], colour, ...lighting];
  };
  const { distance, denominator, values } = bounce;
  const mine = parts({
    ...bounce, distance: isExact ? distance : [distance?.[0], denominator], fromLight: values["slope from the light"],
  });
  const right = golden ? parts({
    ...golden, distance: [golden.numerator, golden.denominator],
    fromLight: light?.position.map((place, axis) => Math.abs(golden.point[axis] - golden.denominator * place)),
  }) : mine.map(() => null);
  return { mine, right, wrong: mine.map((value, part) => JSON.stringify(value) !== JSON.stringify(right[part])) };
}

// Share of each ray's colour in the pixel.
function shares(bounces, scene) {
  let rest = 1;
  return bounces.map(({ winner }, number) => {
    const mirrored = winner < 0 || number === bounces.length - 1 ? 0 : scene.rect[winner].quarters / 4;
    const share = rest * (1 - mirrored);
    rest *= mirrored;
    return share;
  });
}

const rayName = (number) => (number === 0 ? "The camera's ray" : `Reflection ${number}`);

// The page's account of a pixel: explained is the golden model's result, monitor the colour on the screen.
class PixelStory {
  constructor(scene, design, life, explained, monitor) {
    Object.assign(this, { scene, design, life, explained, monitor });
    this.unit = 1 << design.fraction_bits;
    this.isExact = life.bounces.some(({ values }) => "eye" in values);
    this.compared = life.bounces.map(
      (bounce, number) => compare(bounce, explained.bounces[number], this.isExact, scene.light),
    );
    [this.pixel] = life.values.pixel ?? [null];
  }

  get isWrong() {
    const isWhole = this.compared.length === this.explained.bounces.length && this.compared.length > 0;
    const isBlended = [this.pixel, this.monitor].every((colour) => colour === this.explained.colour);
    return !isWhole || !isBlended || this.compared.some(({ wrong }) => wrong.includes(true));
  }

  label(index) {
    return index < 0 ? "nothing" : `${index} ${this.scene.rect[index].name ?? ""}`.trim();
  }

  lighting(shadow) {
    if (shadow === RayCasterLife.LIT) return "lit";
    return shadow === RayCasterLife.DARK_SIDE ? "on the dark side" : `shaded by ${this.label(shadow)}`;
  }

  seen(number) {
    const { mine, right, wrong } = this.compared[number];
    const { light } = this.scene;
    const texts = [
      (winner) => this.label(winner),
      (distance) => (this.isExact ? fractionText(distance) : digits(distance[0] / distance[1])),
      ([point, denominator]) => place(point, denominator),
      swatch,
      (shadow) => this.lighting(shadow),
      (slope) => slope.join(", "),
    ];
    const cells = (values) => values.map((value, part) => (value === null ? "" : texts[part](value)));
    const marked = cells(mine).map((content, part) => ({ content, className: wrong[part] ? "wrong" : "" }));
    const compared = (caption, headings, from, to) => table(caption, ["", ...headings], [
      { cells: ["hardware", ...marked.slice(from, to)] },
      { cells: ["golden model", ...cells(right).slice(from, to)] },
    ]);
    const tables = [compared("", ["sees", this.isExact ? "at t" : "at depth", "at point", "colour"], 0, 4)];
    if (light && (mine[0] >= 0 || right[0] >= 0)) {
      const caption = `Shadow ray, from ${place(light.position, 1)}`;
      tables.push(compared(caption, ["the point is", "slope, magnitudes"], 4));
    }
    return tables;
  }

  tried({ tried, winner }) {
    const probes = this.design.taps.probes.filter(
      ({ quantity, printed }) => printed && tried.some(({ values }) => quantity in values),
    );
    const rows = tried.map((one) => {
      const cells = probes.map((probe) => ({ content: quantityText(probe, one, this.unit), className: "number" }));
      const none = { content: "no ray of the group points towards it", colSpan: probes.length };
      return {
        className: one.rectangle === winner ? "seen" : "",
        cells: [this.label(one.rectangle), ...("inside" in one.values ? cells : [none])],
      };
    });
    const headings = probes.map(({ quantity }) => ({ content: quantity, className: "number" }));
    return rows.length ? [table("Rectangles tested", ["rectangle", ...headings], rows)] : [];
  }

  leftOut({ tried }) {
    const names = this.scene.rect.map((_, index) => index)
      .filter((index) => !tried.some(({ rectangle }) => rectangle === index))
      .map((index) => this.label(index));
    return names.length ? [element("p", `Skipped by culling: ${names.join(", ")}.`, { className: "help" })] : [];
  }

  bounce(bounce, number) {
    const { eye, origin } = bounce.values;
    const from = eye ? place(eye, 1) : place(origin, this.unit);
    const start = eye && number ? `the mirrored eye ${from}` : from;
    const title = `${rayName(number)}, from ${start} along ${place(bounce.slope, 1)}`;
    return [element("h3", title), ...this.seen(number), ...this.tried(bounce), ...this.leftOut(bounce)];
  }

  blended() {
    const held = (name, colour) => {
      const content = colour === null ? "" : swatch(colour);
      return { cells: [name, "", { content, className: colour === this.explained.colour ? "" : "wrong" }] };
    };
    const { bounces } = this.life;
    const parts = shares(bounces, this.scene).map((share, number) => ({
      cells: [rayName(number), { content: digits(share), className: "number" }, swatch(bounces[number].colour)],
    }));
    return [element("h3", "The pixel"), table("", ["", "share", "colour"], [
      ...parts,
      held("hardware", this.pixel), held("monitor", this.monitor), held("golden model", this.explained.colour),
    ])];
  }

  get elements() {
    return [...this.life.bounces.flatMap((bounce, number) => this.bounce(bounce, number)), ...this.blended()];
  }
}

function drawMark(canvas, column, row) {
  const context = canvas.getContext("2d");
  for (const [colour, reach] of [["#000", MARK_REACH + 1], ["#fff", MARK_REACH]]) {
    context.strokeStyle = colour;
    context.strokeRect(column - reach + 0.5, row - reach + 0.5, 2 * reach, 2 * reach);
  }
}

tabs.pixel = {
  async open() {
    const selects = { scene: find("pixel-scene"), engine: find("pixel-engine") };
    const inputs = { column: find("pixel-column"), row: find("pixel-row") };
    const canvas = find("pixel-picture"), status = find("pixel-status");
    fillScenes(selects.scene);
    fill(selects.engine, Object.keys(TAPPED), "exact");
    const judge = await Judge.start();
    let machine = null, loaded = null, chosen = false;

    const start = async (name) => {
      if (machine?.name === name) return;
      loaded = null;
      machine = await Machine.instead(machine, name);
      for (const [input, count] of [[inputs.column, machine.design.columns], [inputs.row, machine.design.rows]]) {
        input.max = count - 1;
        // Start with the pixel in the middle.
        if (!chosen) input.value = count / 2;
      }
      chosen = true;
    };

    const show = (scene, column, row, frame, explained) => {
      const { design } = machine;
      const { columns, fraction_bits: fractionBits, taps: { units } } = design;
      const monitor = rgb(frame.pixels.subarray(4 * (row * columns + column)));
      const life = RayCasterLife.read(design.taps, frame.samples, fractionBits);
      const story = new PixelStory(scene, design, life, explained, monitor);
      draw(canvas, frame.pixels, design);
      drawMark(canvas, column, row);
      drawPlan(find("pixel-plan"), scene, life, (index) => story.label(index));
      find("pixel-life").replaceChildren(...story.elements);
      status.className = story.isWrong ? "error" : "";
      status.textContent = `Column ${column}, row ${row}: ray unit ${column % units} of ${units} took ` +
        `${counted(life.clocks, "clock")}, and ${story.isWrong ? "differs from" : "matches"} the golden model.`;
      RayCaster.state.pixel = { done: true, column, row, wrong: story.isWrong, life, golden: explained, monitor };
    };

    const compute = async () => {
      const name = selects.scene.value, text = sceneText(name);
      RayCaster.state.pixel = { done: false };
      status.className = "";
      status.textContent = "simulating a frame, clock by clock";
      refuseSeed("pixel", selects.engine, readScene(text, name));
      await start(TAPPED[selects.engine.value]);
      const { design } = machine;
      if (!inputs.column.validity.valid || !inputs.row.validity.valid) {
        throw new Error(`Choose a column from 0 to ${design.columns - 1} and a row from 0 to ${design.rows - 1}.`);
      }
      const column = inputs.column.valueAsNumber, row = inputs.row.valueAsNumber;
      const scene = readScene(text, name, design.rectangles);
      if (loaded !== text) await machine.call("load", scene);
      loaded = text;
      const frame = await machine.watch(column, row);
      await judge.look(frame, design);
      show(scene, column, row, frame, await judge.call("explain", column, row, design.columns));
    };

    const ask = latest("pixel", compute);
    for (const control of Object.values({ ...selects, ...inputs })) control.addEventListener("change", ask);
    canvas.addEventListener("click", (event) => {
      const box = canvas.getBoundingClientRect();
      const at = (offset, size, count) => Math.max(0, Math.min(count - 1, Math.floor((offset / size) * count)));
      inputs.column.value = at(event.clientX - box.left, box.width, canvas.width);
      inputs.row.value = at(event.clientY - box.top, box.height, canvas.height);
      ask();
    });
    ask();
    return { run: followRoom(selects.scene, ask) };
  },
};
