// SPDX-License-Identifier: MIT
// The fields of the chosen rectangle and of the room, and what the room costs as hardware.
"use strict";

const FULLEST = 0.9; // share of a chip's look-up tables up to which a design can usually be placed and routed

class Properties {
  constructor(room) {
    this.room = room;
    const list = find("room-rect");
    list.addEventListener("change", () => room.select(Number(list.value)));
    fill(find("room-pattern"), RayCaster.schema.patterns, RayCaster.schema.patterns[0]);
    fill(find("room-cell"), RayCaster.schema.cells);
    const whole = (value) => (value === "" ? null : Math.round(Number(value)));
    const rectangle = (id, key, read) => {
      const field = find(`room-${id}`);
      field.addEventListener("focus", () => room.keep());
      field.addEventListener("input", () => {
        if (!room.rect || !field.validity.valid || field.value === "") return;
        room.keep();
        read(field.value, key);
      });
    };
    const set = (key, value) => room.set("rect", room.selected, key, value);
    rectangle("label", "name", (value) => set("name", value));
    rectangle("colour", "colour", (value) => set("colour", value));
    rectangle("mirror", "mirror", (value) => set("mirror", Number(value)));
    rectangle("colour2", "colour2", (value) => set("colour2", value));
    rectangle("cell", "cell", (value) => set("cell", whole(value)));
    rectangle("pattern", "pattern", (value) => this.setPattern(value));
    find("room-corners").append(...AXES.map((axis) => element("span", axis, { ariaHidden: true })));
    for (const corner of [0, 1]) {
      AXES.forEach((axis, number) => {
        const field = element("input", "", {
          type: "number", min: 0, max: PLAN_TOP, id: `room-corner-${corner}-${axis}`, ariaLabel: `Corner ${corner}, ${axis}`,
        });
        find("room-corners").append(field);
        rectangle(`corner-${corner}-${axis}`, "corners", (value) => {
          const corners = structuredClone(room.rect.corners);
          corners[corner][number] = whole(value);
          set("corners", corners);
        });
      });
    }
    find("room-background").addEventListener("input", ({ target }) => {
      room.keep();
      room.set("", 0, "background", target.value);
    });
    find("room-reflections").addEventListener("change", ({ target }) => {
      room.keep();
      room.set("", 0, "reflections", Number(target.value));
    });
  }

  // A pattern needs a second colour; a plain rectangle may have neither that nor cells.
  setPattern(pattern) {
    const { room } = this, { selected } = room, isPlain = pattern === RayCaster.schema.patterns[0];
    let { text } = room;
    const found = RayCasterText.table(text, "rect", selected).keys;
    if (isPlain) for (const key of ["pattern", ...RayCaster.schema.pattern_keys]) text = RayCasterText.set(text, "rect", selected, key, null);
    else {
      text = RayCasterText.set(text, "rect", selected, "pattern", pattern);
      if (!found.colour2) text = RayCasterText.set(text, "rect", selected, "colour2", "#202428");
    }
    room.show(text);
  }

  show() {
    const { scene, selected, rect } = this.room;
    if (!scene) return;
    const list = find("room-rect"), put = (id, value) => {
      const field = find(`room-${id}`);
      if (document.activeElement !== field || field.type !== "text") field.value = value;
    };
    const names = scene.rect.map(({ name }, index) => `${index} ${name ?? ""}`);
    list.replaceChildren(new Option("choose", -1), ...names.map((name, index) => new Option(name, index)));
    list.value = selected;
    put("background", hex(rgb(scene.background)));
    put("reflections", scene.reflections);
    find("room-light").setAttribute("aria-pressed", scene.light !== null);
    for (const id of ["duplicate", "remove"]) find(`room-${id}`).disabled = !rect;
    find("room-remove").disabled ||= scene.rect.length < 2;
    find("room-rectangle").disabled = !rect;
    if (!rect) return;
    put("label", rect.name ?? "");
    put("colour", hex(rgb(rect.colour)));
    put("mirror", rect.quarters / 4);
    put("pattern", RayCaster.schema.patterns[rect.kind]);
    put("colour2", hex(rgb(rect.colour2)));
    put("cell", rect.cell);
    for (const id of ["colour2", "cell"]) find(`room-${id}`).disabled = rect.kind === 0;
    rect.corners.forEach((corner, number) =>
      AXES.forEach((axis, at) => put(`corner-${number}-${axis}`, corner[at])));
  }
}

// Say what hardware for rooms like this one takes, and which boards have it.
function cellsText(model, { runs }) {
  const { rooms, boards, date } = RayCaster.cost ?? {};
  const { design: name } = RayCaster.walk.models.find(({ name }) => name === model), cells = rooms?.[name];
  if (!cells) return "";
  const titles = boards.filter(
    ({ elements, multipliers, runs: most }) =>
      cells.tables <= FULLEST * elements && cells.multipliers <= multipliers && runs <= most[name],
  ).map(({ title }) => title);
  return ` The ${name} design with 640 x 480 rays takes ${counted(cells.tables, "look-up table")}, ` +
    `${counted(cells.registers, "register")} and ${counted(cells.multipliers, "multiplier")} of an ECP5 (counted before ` +
    `placing, ${date}). Boards with room for it and for this frame: ${titles.join(", ") || "none of those described here"}.`;
}

// List the designs for boards that were placed and routed and have all that a room needs. A design with another number
// of rays needs other lists for it.
function routedTable({ runs, camera }, { needs, reflections, rect }) {
  const turn = JSON.stringify(camera.basis) !== JSON.stringify(RayCasterScene.basis(0, 0, 0));
  const able = (RayCaster.cost?.routed ?? []).filter((one) => runs <= one.runs && rect.length <= one.rectangles &&
    reflections <= one.reflections &&
    Object.entries({ ...needs, turn }).every(([look, isNeeded]) => !isNeeded || one.features.includes(look)));
  if (!able.length) return element("div");
  const oldest = able.map(({ date }) => date).sort()[0];
  const rows = able.map(({ title, serial, columns, rows, runs: most, cells: [used, all], clock: [reached, needed] }) => ({
    cells: [
      title + (serial ? ", serial port" : ""), `${columns} x ${rows}`, most.toLocaleString("en"),
      `${used.toLocaleString("en")} of ${all.toLocaleString("en")}`, reached.toFixed(1), needed.toFixed(1),
    ],
  }));
  return table(`Placed and routed for boards, on ${oldest} or later, with all that this room needs`,
    ["board", "rays", "runs", "logic cells", "MHz", "needs"], rows);
}

// Say how fast hardware with one unit draws this frame, which takes it as many clocks as here, and how to make it.
function showCost(frame, model, design, scene) {
  const { columns, rows, scale } = design, { needs, reflections, rect } = scene, routed = routedTable(frame, scene);
  const rates = CLOCKS.map((clock) => `${((clock * 1e6) / frame.clocks).toFixed(0)} at ${clock} MHz`).join(", ");
  find("room-cost").textContent = `Hardware with one unit of the span engine draws this frame of ${columns} x ${rows} in ` +
    `${counted(frame.clocks, "clock")}. Frames per second: ${rates}.${cellsText(model, frame)} Its Verilog:`;
  const looks = ["materials", "patterns", "light"].filter((look) => needs[look]).map((look) => ` ${look.toUpperCase()}=1`);
  find("room-command").textContent =
    `make verilog ENGINE=span SCALE=${scale} TURN=1${looks.join("")} REFLECTIONS=${reflections} RECTANGLES=${rect.length}`;
  if (routed.textContent !== find("room-routed").textContent) find("room-routed").replaceChildren(routed);
}
