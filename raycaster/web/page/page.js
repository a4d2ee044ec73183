// SPDX-License-Identifier: MIT
// The tabs of the page.
"use strict";

const find = (id) => document.getElementById(id);

// Facts about the last frame of each tab, for tests and for curious readers at the console.
RayCaster.state = {};

function fill(select, names, chosen) {
  select.replaceChildren(...names.map((name) => new Option(name, name, false, name === chosen)));
}

const OWN = "your room";

// Offer the packaged scenes and the room; choose the room if it is none of these.
function fillScenes(select) {
  const { room } = RayCaster, isOwn = room.text !== "" && !room.isPackaged;
  fill(select, [...(room.text ? [OWN] : []), ...Object.keys(RayCaster.scenes)], isOwn ? OWN : RayCaster.walk.first);
}

// Return a function that a tab calls each time it is shown: the room is a choice as soon as there is one, and is drawn
// again if it has changed.
function followRoom(select, ask) {
  const { room } = RayCaster;
  let { text } = room;
  return () => {
    if (room.text && select.options[0].value !== OWN) select.prepend(new Option(OWN));
    if (select.value === OWN && text !== room.text) ask();
    ({ text } = room);
  };
}

const sceneText = (name) => (name === OWN ? RayCaster.room.text : RayCaster.scenes[name]);

const rgb = ([red, green, blue]) => (red << 16) | (green << 8) | blue;

const counted = (count, noun) => `${count.toLocaleString("en")} ${noun}${count === 1 ? "" : "s"}`;

// Say in one line why the seed engine refuses a scene; "" if it does not.
function refusal(scene) {
  const reason = Object.entries(RayCaster.seed.lacks).findLast(([look]) => scene.needs[look])?.[1];
  return reason ? `The seed engine refuses this scene: ${reason.replace("the seed engine", "it")}.` : "";
}

const TAPPED = { exact: "exact", seed: "seed-0" }; // models with taps, by engine

// Say in a tab why the seed engine refuses a scene, and choose another engine.
function refuseSeed(id, engines, scene) {
  const refused = refusal(scene);
  [...engines.options].find(({ value }) => value === "seed").disabled = refused !== "";
  if (refused) engines.value = "exact";
  find(`${id}-refusal`).textContent = refused;
}

// Return the fastest model that draws a scene, if possible with this number of columns; undefined if there is none.
function modelOf(scene, columns) {
  const able = RayCaster.walk.models.filter(
    ({ features, reflections, rectangles }) => reflections >= scene.reflections && rectangles >= scene.rect.length &&
      Object.entries(scene.needs).every(([name, isNeeded]) => !isNeeded || features.includes(name)),
  );
  return able.find((model) => model.columns === columns) ?? able[0];
}

// Read a scene file's text into the form that the hardware loads.
function readScene(text, name, rectangles) {
  const { scene, error } = RayCasterScene.read(text, name, RayCaster.schema, rectangles);
  if (error) throw new Error(error);
  const { yaw, pitch, roll } = scene.camera;
  return { ...scene, basis: RayCasterScene.basis(yaw, pitch, roll) };
}

// Keys and on-screen buttons that are held down.
class Held {
  constructor(names, keys, canvas, pad) {
    this.names = new Set();
    const byKey = new Map(Object.entries(keys).flatMap(([name, of]) => of.map((key) => [key, name])));
    const set = (name, held) => (held ? this.names.add(name) : this.names.delete(name));
    // A field takes the keys that it understands; letters in a menu are for the picture.
    const isTaken = ({ target, key }) =>
      target.matches("textarea, input:not([type=color], [type=checkbox], [type=file])") ||
      (target.matches("input, select, [role=tab]:focus-visible, summary") && (key.length > 1 || key === " "));
    const active = () => !canvas.closest("section").hidden;
    document.addEventListener("keydown", (event) => {
      const name = byKey.get(event.key.toLowerCase());
      if (!name || isTaken(event) || !active() || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      set(name, true);
    }, true);
    document.addEventListener("keyup", (event) => set(byKey.get(event.key.toLowerCase()), false));
    addEventListener("blur", () => this.names.clear());
    for (const name of names) {
      const button = document.createElement("button");
      button.textContent = name;
      button.addEventListener("pointerdown", () => set(name, true));
      for (const end of ["pointerup", "pointerleave", "pointercancel"]) {
        button.addEventListener(end, () => set(name, false));
      }
      pad.append(button);
    }
  }

  has(name) {
    return this.names.has(name);
  }
}

// Shows a machine's frames, with the result of the check, while its tab is shown.
class Show {
  constructor(id, canvas, status) {
    Object.assign(this, { id, canvas, status, rate: 0, frames: 0, verdict: null, running: false });
  }

  shows() {
    return !this.canvas.closest("section").hidden && !document.hidden;
  }

  // Show frames until the tab is left; `next` returns a promise of the next frame.
  async run(machine, judge, next) {
    if (this.running) return;
    this.running = true;
    let before = performance.now();
    while (this.shows()) {
      const frame = await next();
      if (!frame.pixels) continue;
      if (machine.design !== this.design) this.rate = 0;
      this.design = machine.design;
      draw(this.canvas, frame.pixels, machine.design);
      if (this.verdict?.count) mark(this.canvas, this.verdict.wrong, "#ff00ff");
      this.frames++;
      const now = performance.now(), rate = 1000 / (now - before);
      before = now;
      this.rate = this.rate ? 0.9 * this.rate + 0.1 * rate : rate;
      const { clocks, milliseconds, camera } = frame;
      this.last = { hash: pictureHash(frame.pixels), clocks, milliseconds, camera };
      judge.look(frame, machine.design).then((verdict) => (this.verdict = verdict ?? this.verdict));
      this.say(machine.design, frame);
    }
    this.running = false;
  }

  say(design, frame) {
    const parts = [`${this.rate.toFixed(1)} frames per second`, counted(frame.clocks, "clock") + " per frame"];
    this.status.textContent = parts.join(", ");
    const wrong = this.verdict?.count ?? null;
    if (wrong !== null) {
      const note = document.createElement("span");
      if (wrong) note.className = "wrong";
      note.textContent = `, ${counted(wrong, "wrong pixel")} of ${(design.columns * design.rows).toLocaleString("en")}`;
      this.status.append(note);
    }
    RayCaster.state[this.id] = { ...this.last, frames: this.frames, rate: this.rate, wrong };
  }
}

// Return a function that asks for a computation. There is one at a time; of the requests meanwhile, only the last counts.
function latest(id, compute) {
  let runs = false, asked = false;
  return async () => {
    asked = true;
    if (runs) return;
    runs = true;
    while (asked) {
      asked = false;
      await compute().catch((error) => showFailure(id, error));
    }
    runs = false;
  };
}

function showFailure(id, error) {
  const status = find(`${id}-status`) ?? find(`${id}-exact-status`);
  status.textContent = error.message;
  status.className = "error";
  RayCaster.state[id] = { error: error.message };
}

// The camera of a walk.
class Walker {
  constructor(scene) {
    this.place = [...scene.camera.position];
    ({ yaw: this.yaw, pitch: this.pitch, roll: this.roll } = scene.camera);
  }

  move(held, [right, down], seconds) {
    const { speed, turn, drag, steepest, world_size: size } = RayCaster.walk;
    const pair = (more, less) => seconds * (held.has(more) - held.has(less));
    this.yaw += turn * pair("turn right", "turn left") + drag * right;
    this.yaw -= 360 * Math.round(this.yaw / 360);
    const pitch = this.pitch + turn * pair("look up", "look down") - drag * down;
    this.pitch = Math.max(-steepest, Math.min(steepest, pitch));
    const angle = (this.yaw * Math.PI) / 180;
    const along = speed * pair("forward", "back"), across = speed * pair("right", "left");
    const steps = [
      along * Math.cos(angle) - across * Math.sin(angle),
      along * Math.sin(angle) + across * Math.cos(angle),
      speed * pair("rise", "sink"),
    ];
    this.place = this.place.map((place, axis) => Math.max(0, Math.min(size - 1, place + steps[axis])));
  }

  get camera() {
    return { position: this.place.map(Math.round), basis: RayCasterScene.basis(this.yaw, this.pitch, this.roll) };
  }
}

const tabs = {
  game: {
    async open() {
      const canvas = find("game-picture"), said = find("game-text");
      const show = new Show("game", canvas, find("game-status"));
      const { buttons, keys } = RayCaster.game;
      const held = new Held(buttons, keys, canvas, find("game-pad"));
      const judge = await Judge.start();
      const machine = await Machine.start("game");
      const frame = async () => {
        const bits = buttons.reduce((sum, name, bit) => sum | (held.has(name) << bit), 0);
        const frame = await machine.frame({ buttons: bits });
        if (frame.text) {
          said.append(frame.text);
          said.scrollTop = said.scrollHeight;
        }
        return frame;
      };
      return { run: () => show.run(machine, judge, frame) };
    },
  },
};

const opened = {};
const FIRST_TAB = "room";

// Return the tab that an address names; a room in the address has the tab of rooms.
function tabOf(hash) {
  const [name] = hash.slice(1).split("=");
  return name in tabs ? name : FIRST_TAB;
}

async function open(id) {
  for (const tab of document.querySelectorAll("[role=tab]")) {
    const chosen = tab.id === `tab-${id}`;
    tab.setAttribute("aria-selected", chosen);
    tab.tabIndex = chosen ? 0 : -1;
    find(tab.getAttribute("aria-controls")).hidden = !chosen;
  }
  try {
    opened[id] ??= tabs[id].open();
    await (await opened[id]).run?.();
  } catch (error) {
    showFailure(id, error);
  }
}

addEventListener("DOMContentLoaded", () => {
  const list = [...document.querySelectorAll("[role=tab]")];
  for (const tab of list) {
    tab.addEventListener("click", () => (location.hash = tab.id.slice(4)));
    tab.addEventListener("keydown", ({ key }) => {
      const step = { ArrowRight: 1, ArrowLeft: -1 }[key];
      if (step) list[(list.indexOf(tab) + step + list.length) % list.length].focus();
    });
  }
  const parameters = new URLSearchParams(location.search);
  const planted = parameters.get("plant")?.split(",").map(Number);
  if (RayCaster.test && planted) {
    RayCaster.plant = (pixels, columns) => (pixels[4 * (planted[1] * columns + planted[0])] ^= 0x80);
  }
  const go = () => open(tabOf(location.hash));
  addEventListener("hashchange", go);
  document.addEventListener("visibilitychange", () => document.hidden || go());
  go();
});
