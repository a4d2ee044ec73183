// SPDX-License-Identifier: MIT
// The tab of the monitor: all that it receives in a frame, painted as it comes.
"use strict";

const SLICE_LINES = 8, BEAM_LINES = 2; // lines per message of the machine, and of the mark below them
const RECEIVED = { VISIBLE: 1, HS: 2, VS: 4, LATE: 8 }; // bits of a clock, as in machine.cpp
const RASTER = { blanking: "#30343c", hs: "#2f5878", vs: "#6a4a80", late: "#c03030", beam: "#ffd34d" };

// A picture's word of a colour: red, green, blue and 255.
function wordOf(colour) {
  const channels = colour.match(/[0-9a-f]{2}/g).map((digits) => Number.parseInt(digits, 16));
  return new Uint32Array(new Uint8Array([...channels, 255]).buffer)[0];
}

// Places what a monitor receives, from the beginnings of the syncs only.
class Raster {
  constructor({ columns, lines, hs, vs }, doubling) {
    Object.assign(this, { columns, lines, doubling, levels: (hs && RECEIVED.HS) | (vs && RECEIVED.VS), last: null });
    this.words = new Uint32Array(columns * lines);
    this.colours = Object.fromEntries(Object.entries(RASTER).map(([name, colour]) => [name, wordOf(colour)]));
    this.column = this.line = this.before = 0;
    this.begin();
  }

  begin() {
    this.counts = { clocks: 0, lines: 1, longest: 0, displayed: 0, hs: 0, vs: 0, blanking: 0, lateRows: 0, late: 0 };
    this.lateTo = -1;
  }

  receive(words) {
    for (const word of words) {
      const bits = (word >>> 24) ^ (~this.levels & (RECEIVED.HS | RECEIVED.VS)), begun = bits & ~this.before;
      this.before = bits;
      this.column++;
      if (begun & RECEIVED.VS) {
        this.last = this.counts;
        this.begin();
        this.line = this.column = 0;
      } else if (begun & RECEIVED.HS) {
        this.line++;
        this.counts.lines++;
        this.column = 0;
      }
      this.place(word, bits);
    }
  }

  place(word, bits) {
    const { counts, colours, column, line } = this;
    counts.clocks++;
    counts.longest = Math.max(counts.longest, column + 1);
    if (bits & RECEIVED.LATE) {
      counts.lateRows++;
      this.lateTo = line + this.doubling;
    }
    const isLate = line <= this.lateTo;
    const blanked = bits & RECEIVED.HS ? "hs" : bits & RECEIVED.VS ? "vs" : "blanking";
    const part = bits & RECEIVED.VISIBLE ? "displayed" : blanked;
    counts[part]++;
    if (isLate && part === "displayed") counts.late++;
    const colour = part === "displayed" ? word | 0xff000000 : colours[isLate && part === "blanking" ? "late" : part];
    if (column < this.columns && line < this.lines) this.words[line * this.columns + column] = colour;
  }

  // Draw the lines from `first` on, up to the last one received or to the end, and mark the place below.
  draw(context, first, isEnd) {
    const { columns, lines, words, line } = this, height = (isEnd ? lines : line + 1) - first;
    const image = new ImageData(new Uint8ClampedArray(words.buffer), columns, lines);
    context.putImageData(image, 0, 0, 0, first, columns, height);
    context.fillStyle = RASTER.beam;
    if (!isEnd) context.fillRect(0, line + 1, columns, BEAM_LINES);
  }
}

// Count the parts of a frame, each with its colour in the raster.
function rasterTable({ clocks, displayed, hs, vs, blanking, late, lateRows }) {
  const row = (colour, name, count) => ({ cells: [
    colour ? element("span", "", { className: "swatch", style: `background: ${colour}` }) : "", name,
    { content: count.toLocaleString("en"), className: "number" },
    { content: `${((100 * count) / clocks).toFixed(1)} %`, className: "number" },
  ] });
  return table("", ["", "part of a frame", "clocks", "share"], [
    row("", "displayed", displayed), row(RASTER.blanking, "blanking", blanking),
    row(RASTER.hs, "horizontal sync", hs), row(RASTER.vs, "vertical sync", vs),
    row(RASTER.late, `in ${counted(lateRows, "late row")}`, late),
  ]);
}

tabs.monitor = {
  async open() {
    const selects = { scene: find("monitor-scene"), engine: find("monitor-engine") };
    const panel = find("monitor-panel"), canvas = find("monitor-raster"), status = find("monitor-status");
    fillScenes(selects.scene);
    fill(selects.engine, Object.keys(TAPPED), "exact");
    const judge = await Judge.start();
    let machine = null, raster = null, shown = "", isAsked = true, isEnd = true, running = false;

    // Load the scene, which the hardware takes before the first row of the frame.
    const load = async () => {
      const name = selects.scene.value, text = sceneText(name);
      shown = "";
      refuseSeed("monitor", selects.engine, readScene(text, name));
      const before = machine;
      machine = await Machine.instead(machine, TAPPED[selects.engine.value]);
      const { design } = machine;
      if (machine !== before) {
        raster = new Raster(design.monitor, design.doubling);
        Object.assign(canvas, { width: raster.columns, height: raster.lines });
      }
      await machine.call("load", readScene(text, name, design.rectangles));
      shown = name;
    };

    const say = ({ pixels, words }, speed) => {
      const { design } = machine, { last: counts } = raster, { clocks, longest, lines } = counts, scene = shown;
      judge.look({ pixels, words }, design).then((verdict) => {
        if (shown !== scene) return;
        const { hz } = design.monitor, wrong = verdict?.count ?? null;
        status.className = wrong ? "error" : "";
        status.textContent = `${counted(clocks, "clock")} per frame, ${lines} lines of ${longest}: ` +
          `${(hz / clocks).toFixed(1)} frames per second at ${hz / 1e6} MHz` +
          (speed ? `, ${speed.toFixed(2)} in this page` : "") +
          (wrong === null ? "" : `, ${counted(wrong, "pixel")} different from the golden model`);
        find("monitor-counts").replaceChildren(rasterTable(counts));
        RayCaster.state.monitor = {
          scene, wrong, counts,
          get raster() {
            return pictureHash(new Uint8Array(raster.words.buffer));
          },
        };
      });
    };

    const run = async () => {
      if (running) return;
      running = true;
      let began = null;
      try {
        while (!panel.hidden && !document.hidden) {
          if (isEnd) {
            if (isAsked) {
              isAsked = false;
              await load();
            }
            began = performance.now();
          }
          const first = isEnd ? 0 : raster.line, part = await machine.scan(SLICE_LINES * raster.columns);
          raster.receive(part.received);
          isEnd = part.ended;
          raster.draw(canvas.getContext("2d"), first, isEnd);
          // A frame that was interrupted has no speed.
          if (isEnd) say(part, began && 1000 / (performance.now() - began));
        }
      } finally {
        running = false;
      }
    };
    const ask = () => {
      isAsked = true;
      run().catch((error) => showFailure("monitor", error));
    };
    for (const select of Object.values(selects)) select.addEventListener("change", ask);
    const follow = followRoom(selects.scene, ask);
    return {
      run() {
        follow();
        return run();
      },
    };
  },
};
