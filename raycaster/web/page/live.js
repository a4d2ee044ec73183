// SPDX-License-Identifier: MIT
// The tab of the room: picture, plans and text, each of which follows the others.
"use strict";

const CLOCKS = [25, 74.25];      // MHz, for which the frame rate of hardware is given
const REST = 4;                  // pause after a check of a picture, in lengths of that check
const REPORTING = 100;           // ms between changes of the text and the plans while the picture moves
const CLICK_REACH = 4;           // most movement of a click, in pixels of the page
const ADDRESS_DELAY = 400;       // ms from a change to the address with it
const TYPING_DELAY = 600;        // ms without a key after which typing is one step of undo
const LONGEST_STEP = 0.1;        // s, most that the camera moves in one frame
const FASTEST = 70, SLOWEST = 2; // frames per second: more than the display shows, and less than a pause
const NEW_RECTANGLE = { name: "new", colour: "#8fa3c0", mirror: 0 };
const NEW_SIZE = 64, NEW_DISTANCE = 120;

const later = (delay, action) => {
  let timer = 0;
  return () => {
    clearTimeout(timer);
    timer = setTimeout(action, delay);
  };
};

// Compare pictures with the golden model as far as time allows, and count.
class Checks {
  constructor(judge) {
    Object.assign(this, { judge, compared: 0, different: 0, verdict: null, last: 0, waiting: null, until: 0 });
  }

  offer(frame, design, number) {
    this.waiting = { frame, design, number };
    this.run();
  }

  async run() {
    if (this.runs) return;
    this.runs = true;
    while (this.waiting) {
      const { frame, design, number } = this.waiting, began = performance.now();
      this.waiting = null;
      this.verdict = await this.judge.call("judge", frame.words, frame.pixels, design);
      this.shown = { number, design };
      this.compared += design.columns * design.rows;
      this.different += this.verdict.count;
      this.last = number;
      await new Promise((resolve) => setTimeout(resolve, REST * (performance.now() - began)));
    }
    this.runs = false;
  }
}

tabs.room = {
  async open() {
    const { room } = RayCaster, canvas = find("room-picture"), text = find("room-text");
    const held = new Held(RayCaster.walk.buttons, RayCaster.walk.keys, canvas, find("room-pad"));
    const checks = new Checks(await Judge.start());
    let walker = null, textCamera = "", drawing = null, frames = 0, rate = 0, last = null, look = [0, 0], typing = false;

    const copyCamera = () => {
      if (!walker) return;
      const turns = { yaw: walker.yaw, pitch: walker.pitch, roll: walker.roll };
      const rounded = (angle) => Number(angle.toFixed(1));
      let changed = RayCasterText.set(room.text, "camera", 0, "position", walker.camera.position);
      for (const [key, angle] of Object.entries(turns)) {
        const isThere = RayCasterText.table(changed, "camera")?.keys[key];
        if (isThere || rounded(angle) !== 0) changed = RayCasterText.set(changed, "camera", 0, key, rounded(angle));
      }
      room.show(changed);
    };
    const ways = { walker: () => walker, copyCamera };
    const plans = [new Plan(find("room-above"), "above", room, ways), new Plan(find("room-side"), "side", room, ways)];
    const drawPlans = () => plans.forEach((plan) => plan.draw());

    // The text with its line numbers; a wrong line is marked while one types.
    const showLines = () => {
      const wrong = room.error ? RayCasterText.errorLine(room.text, room.error) : 0;
      const chosen = room.selected < 0 ? null : RayCasterText.table(room.text, "rect", room.selected);
      const first = chosen ? RayCasterText.lineOf(room.text, chosen.start) : 0;
      const kept = chosen ? room.text.slice(chosen.start, chosen.end).trimEnd().split("\n").length : 0;
      const numbers = room.text.split("\n").map((_, index) => {
        const line = element("span", `${index + 1}\n`);
        if (index + 1 === wrong) line.className = "wrong";
        else if (index + 1 >= first && index + 1 < first + kept) line.className = "chosen";
        return line;
      });
      find("room-lines").replaceChildren(...numbers);
      find("room-error").textContent = room.error;
      text.setAttribute("aria-invalid", room.error !== "");
    };
    const scrollTo = (index) => {
      const found = RayCasterText.table(room.text, "rect", index);
      if (!found) return;
      const height = Number.parseFloat(getComputedStyle(text).lineHeight);
      text.scrollTop = (RayCasterText.lineOf(room.text, found.start) - 3) * height;
      text.setSelectionRange(found.start, found.start);
    };
    text.addEventListener("scroll", () => (find("room-lines").scrollTop = text.scrollTop));

    const properties = new Properties(room);
    const writeAddress = later(ADDRESS_DELAY, async () => {
      if (tabOf(location.hash) !== "room") return;
      const address = room.isPackaged ? "#room" : LINK + (await packText(room.text));
      try {
        history.replaceState(null, "", address);
      } catch {
        // Some browsers refuse this for pages from a disk.
      }
    });
    const changed = () => {
      if (text.value !== room.text) text.value = room.text;
      const { camera } = room.scene ?? {};
      if (camera && JSON.stringify(camera) !== textCamera) {
        textCamera = JSON.stringify(camera);
        walker = new Walker(room.scene);
      }
      showLines();
      properties.show();
      drawPlans();
      writeAddress();
      find("room-undo").disabled = !room.before.length;
      find("room-redo").disabled = !room.after.length;
    };
    room.addEventListener("change", changed);
    room.addEventListener("settled", changed);
    room.addEventListener("select", () => {
      scrollTo(room.selected);
      changed();
    });

    const endTyping = later(TYPING_DELAY, () => (typing = false));
    text.addEventListener("input", () => {
      if (!typing) room.keep();
      typing = true;
      endTyping();
      room.show(text.value);
    });
    text.addEventListener("click", () => {
      const at = RayCasterText.tables(room.text).filter(({ name }) => name === "rect")
        .findIndex(({ start, end }) => text.selectionStart >= start && text.selectionStart < end);
      if (at >= 0 && at !== room.selected) {
        room.selected = at;
        changed();
      }
    });
    document.addEventListener("keydown", (event) => {
      if (find("room-panel").hidden || !(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
      event.preventDefault();
      typing = false;
      if (event.shiftKey) room.redo();
      else room.undo();
    });

    const open = (source, name) => {
      textCamera = "";
      room.open(source, name);
      find("room-name").textContent = name;
    };
    const openFile = async (file) => file && open(await file.text(), file.name);
    const panel = find("room-panel");
    panel.addEventListener("dragover", (event) => event.preventDefault());
    panel.addEventListener("drop", (event) => {
      event.preventDefault();
      openFile(event.dataTransfer.files[0]);
    });
    find("room-file").addEventListener("change", ({ target }) => openFile(target.files[0]));

    const say = (said) => {
      find("room-said").textContent = said;
      setTimeout(() => (find("room-said").textContent = ""), 4000);
    };
    const download = (url, name) => {
      const anchor = element("a", "", { href: url, download: name });
      anchor.click();
    };
    const place = (index, values) => {
      const list = RayCasterText.tables(room.text).filter(({ name }) => name === "rect");
      room.change(RayCasterText.add(room.text, "[[rect]]", values, list[index]));
    };
    const inFront = () => {
      const { position } = walker.camera, yaw = (walker.yaw * Math.PI) / 180;
      const centre = [position[0] + NEW_DISTANCE * Math.cos(yaw), position[1] + NEW_DISTANCE * Math.sin(yaw), position[2]];
      const grid = Number(find("room-grid").value), half = NEW_SIZE / 2;
      return centre.map((one) => Math.max(half, Math.min(PLAN_TOP - half, Math.round(one / grid) * grid)));
    };
    const actions = {
      undo: () => room.undo(),
      redo: () => room.redo(),
      add() {
        const [x, y, z] = inFront(), half = NEW_SIZE / 2;
        const corners = [[x, y - half, z - half], [x, y + half, z + half]];
        place(-1, { name: NEW_RECTANGLE.name, corners, colour: NEW_RECTANGLE.colour, mirror: 0 });
        room.select(room.scene.rect.length - 1);
      },
      box() {
        const [x, y, z] = inFront(), half = NEW_SIZE / 2, low = [x, y, z].map((one) => one - half);
        const high = low.map((one) => one + NEW_SIZE);
        let changed = room.text;
        [0, 1, 2].forEach((axis) => {
          for (const end of [low, high]) {
            const corners = [[...low], [...high]];
            corners[0][axis] = corners[1][axis] = end[axis];
            const colour = ["#8fa3c0", "#6f83a0", "#afc3e0"][axis];
            const name = `box ${AXES[axis]} ${end === low ? "low" : "high"}`;
            changed = RayCasterText.add(changed, "[[rect]]", { name, corners, colour, mirror: 0 });
          }
        });
        room.change(changed);
      },
      duplicate() {
        const { selected } = room;
        room.change(RayCasterText.duplicate(room.text, selected));
        room.select(selected + 1);
      },
      remove() {
        const { selected } = room;
        room.selected = -1;
        room.change(RayCasterText.remove(room.text, "rect", selected));
      },
      light() {
        if (room.scene.light) room.change(RayCasterText.remove(room.text, "light"));
        else room.change(RayCasterText.add(room.text, "[light]", { position: walker.camera.position, shade: 0.25 },
          RayCasterText.table(room.text, "camera")));
      },
      camera() {
        room.keep();
        copyCamera();
        say("This camera is in the text.");
      },
      async link() {
        const address = `${location.href.split("#")[0]}${LINK}${await packText(room.text)}`;
        try {
          await navigator.clipboard.writeText(address);
          say("The link is copied.");
        } catch {
          location.hash = address.split("#")[1];
          say("The link is in the address bar.");
        }
      },
      save() {
        const url = URL.createObjectURL(new Blob([room.text], { type: "application/toml" }));
        download(url, room.name.endsWith(".toml") ? room.name : "room.toml");
        setTimeout(() => URL.revokeObjectURL(url), 1000);
      },
      async board() {
        try {
          const port = await navigator.serial.requestPort(), { camera } = walker;
          const design = await RayCasterBoard.send(port, { ...room.scene, camera }, camera.basis);
          say(`The board shows this room, with the ${design.name} engine.`);
        } catch (error) {
          say(`Not sent: ${error.message}`);
        }
      },
      picture: () => download(canvas.toDataURL(), `${room.name.replace(/\.toml$/, "") || "room"}.png`),
      full: () => canvas.requestFullscreen(),
    };
    find("room-board").hidden = !navigator.serial;
    for (const [name, action] of Object.entries(actions)) {
      find(`room-${name === "picture" ? "picture-save" : name}`).addEventListener("click", (event) => {
        action();
        // Keys go back to the picture after a click, but not after the keyboard chose a button.
        if (event.detail) event.currentTarget.blur();
      });
    }
    const sizes = new Map(RayCaster.walk.models.map(({ columns, rows }) => [columns, `${columns} x ${rows}`]));
    find("room-size").replaceChildren(...Array.from(sizes, ([columns, size]) => new Option(size, columns)));
    find("room-size").addEventListener("change", () => room.version++);
    find("room-plant").addEventListener("change", ({ target }) => {
      RayCaster.plant = target.checked ? (pixels, columns) => (pixels[4 * (30 * columns + 40)] ^= 0x80) : undefined;
      room.version++;
      target.blur();
    });
    for (const select of panel.querySelectorAll("select")) {
      let pointed = false;
      select.addEventListener("pointerdown", () => (pointed = true));
      select.addEventListener("change", () => {
        if (pointed) select.blur();
        pointed = false;
      });
    }
    for (const [name, source] of Object.entries(RayCaster.scenes)) {
      const picture = element("img", "", { src: RayCaster.thumbnails[name], alt: "", width: 64, height: 48 });
      const button = element("button", [picture, element("span", name.replaceAll("_", " "))], { type: "button" });
      button.dataset.scene = name;
      button.addEventListener("click", (event) => {
        open(source, `${name}.toml`);
        if (event.detail) button.blur();
      });
      find("room-gallery").append(button);
    }

    let pressed = null;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      canvas.focus({ preventScroll: true });
      pressed = { x: event.clientX, y: event.clientY };
    });
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) look = [look[0] + event.movementX, look[1] + event.movementY];
    });
    canvas.addEventListener("pointerup", async (event) => {
      if (!pressed || !last || Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) > CLICK_REACH) return;
      const box = canvas.getBoundingClientRect(), { columns, rows } = last.design;
      const at = (offset, size, count) => Math.max(0, Math.min(count - 1, Math.floor((offset / size) * count)));
      const column = at(event.clientX - box.left, box.width, columns), row = at(event.clientY - box.top, box.height, rows);
      await checks.judge.call("judge", last.words, last.pixels, last.design);
      const { bounces } = await checks.judge.call("explain", column, row, columns);
      room.select(bounces[0]?.winner ?? -1);
    });

    const fromAddress = async () => {
      if (!location.hash.startsWith(LINK)) return false;
      try {
        const source = await unpackText(location.hash.slice(LINK.length));
        if (source !== room.text) open(source, "room.toml");
        return true;
      } catch {
        say("The address holds no room.");
        return false;
      }
    };
    addEventListener("hashchange", fromAddress);
    if (!(await fromAddress())) open(RayCaster.scenes[RayCaster.walk.first], `${RayCaster.walk.first}.toml`);

    // Text below the picture, and plans, of the last frame. They take longer than the picture itself.
    let reported = 0, reportedAt = 0;
    const report = () => {
      const { design, clocks, runs, camera, drawing: { name, shares } } = last, { columns, rows } = design;
      const speed = rate ? `${rate.toFixed(0)} frames per second, ` : "";
      find("room-status").textContent = `${speed}${counted(clocks, "clock")} and ${counted(runs, "run")} ` +
        `per frame of ${columns} x ${rows}, ${counted(shares.length, "simulated unit")}`;
      find("room-place").textContent =
        `Camera at ${camera.position.join(", ")}, yaw ${walker.yaw.toFixed(0)}°, pitch ${walker.pitch.toFixed(0)}°`;
      showCost(last, name, design, room.scene);
      drawPlans();
      reportChecks();
      reported = frames;
      reportedAt = performance.now();
    };
    const reportChecks = () => {
      const { compared, different, last: checked, verdict } = checks;
      const line = find("room-compared");
      const text = `Pixels compared with exact arithmetic: ${compared.toLocaleString("en")}, different: ` +
        `${different.toLocaleString("en")}.`;
      if (line.textContent !== text) line.textContent = text;
      line.className = different ? "wrong" : "";
      Object.assign(RayCaster.state.room, {
        compared, different, wrong: checked === frames ? (verdict?.count ?? null) : null,
      });
    };

    // Begin a frame if the room or the camera has changed; null if not.
    let begunVersion = -1, begunCamera = "";
    const begin = async (seconds) => {
      if (!room.scene) return null;
      walker.move(held, look, seconds);
      look = [0, 0];
      const { camera } = walker, { version } = room, view = JSON.stringify(camera);
      if (version === begunVersion && view === begunCamera) return null;
      const scene = version === begunVersion ? null : { ...room.scene, camera, basis: camera.basis };
      begunVersion = version;
      begunCamera = view;
      if (scene) {
        const { name } = modelOf(scene, Number(find("room-size").value));
        if (drawing?.name !== name) rate = 0;
        drawing = await Drawing.instead(drawing, name);
      }
      return { drawing, version, camera, frame: drawing.frame({ scene, camera }) };
    };

    let shownAt = 0, marked = 0;
    const show = (begun, frame) => {
      const { drawing, camera, version } = begun, { pixels, clocks, runs } = frame;
      last = { ...frame, camera, version, drawing, design: drawing.design };
      draw(canvas, pixels, last.design);
      frames++;
      checks.offer(frame, last.design, frames);
      const now = performance.now(), speed = 1000 / (now - shownAt);
      shownAt = now;
      // The first frame after a pause has no speed.
      if (speed > SLOWEST) rate = rate ? 0.9 * rate + 0.1 * speed : speed;
      RayCaster.state.room = {
        get hash() {
          return pictureHash(pixels);
        },
        clocks, runs, frames, rate, version, camera, model: drawing.name, wrong: null,
      };
      if (now - reportedAt > REPORTING) report();
    };
    const rest = () => {
      if (checks.last === frames && marked !== frames && checks.verdict?.count) {
        mark(canvas, checks.verdict.wrong, "#ff00ff");
        marked = frames;
      }
      if (reported !== frames) report();
      else if (frames) reportChecks();
    };

    const frameAfterFrame = async () => {
      let before = performance.now(), begun = null;
      const next = async () => {
        const now = performance.now(), seconds = Math.min(LONGEST_STEP, (now - before) / 1000);
        before = now;
        return begin(seconds);
      };
      while (!panel.hidden && !document.hidden) {
        begun ??= await next();
        if (!begun) {
          rest();
          await new Promise(requestAnimationFrame);
          continue;
        }
        const shown = begun, frame = await shown.frame;
        // A fast frame waits for the display. The next one is drawn while this one is shown.
        if (performance.now() - shownAt < 1000 / FASTEST) await new Promise(requestAnimationFrame);
        begun = await next();
        show(shown, frame);
      }
      // A frame that has begun when the tab is left is shown later, as it is.
      if (begun) show(begun, await begun.frame);
    };

    let running = false;
    const run = async () => {
      if (running) return;
      running = true;
      try {
        await frameAfterFrame();
      } finally {
        running = false;
      }
    };
    return { run };
  },
};
