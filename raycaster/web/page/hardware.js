// SPDX-License-Identifier: MIT
// The hardware as seen by the page: machines in workers, and the check of their pictures.
"use strict";

const MOST_SHARES = 8; // workers that share the rows of a frame

const RayCaster = {
  // Filled by the other files of the page: models, scenes, schema, worker.
  models: {},
  test: false,

  async unpack(base64) {
    const packed = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  },

  // A model's file is loaded on first use, by a script element, because a page opened from disk may not use fetch.
  async model(name) {
    if (!RayCaster.models[name]) {
      await new Promise((resolve, reject) => {
        const script = document.createElement("script");
        script.src = `models/${name}.js`;
        script.onload = resolve;
        script.onerror = () => reject(new Error(`models/${name}.js cannot be loaded`));
        document.head.append(script);
      });
    }
    const { design, wasm, program } = RayCaster.models[name];
    const text = program ? new TextDecoder().decode(await RayCaster.unpack(program)) : "";
    return { design, module: await WebAssembly.compile(await RayCaster.unpack(wasm)), program: text };
  },
};

// A worker whose functions return promises.
class Remote {
  constructor() {
    const source = URL.createObjectURL(new Blob([RayCaster.worker], { type: "text/javascript" }));
    this.worker = new Worker(source);
    this.asked = new Map();
    this.worker.onmessage = ({ data: { id, result, error } }) => {
      const { resolve, reject } = this.asked.get(id);
      this.asked.delete(id);
      if (error === undefined) resolve(result);
      else reject(new Error(error));
    };
    this.next = 0;
  }

  call(call, ...parameters) {
    return new Promise((resolve, reject) => {
      this.asked.set(this.next, { resolve, reject });
      this.worker.postMessage({ id: this.next++, call, parameters });
    });
  }

  end() {
    this.worker.terminate();
    this.name = null;
  }
}

// A running design.
class Machine extends Remote {
  static async start(name) {
    const machine = new Machine();
    const { design, module, program } = await RayCaster.model(name);
    machine.name = name;
    machine.design = design;
    await machine.call("start", module, design, program);
    return machine;
  }

  // Return a running design of this name: the given one, or a new one that replaces it.
  static async instead(machine, name) {
    if (machine?.name === name) return machine;
    machine?.end();
    return Machine.start(name);
  }

  // Compute a frame; its picture has one pixel per ray.
  async frame(input) {
    return this.ofRays(await this.call("frame", input));
  }

  // Compute a frame and record the taps for one pixel; only for designs with taps.
  async watch(column, row) {
    return this.ofRays(await this.call("watch", column, row));
  }

  // Run on for some clocks of the monitor; with the last ones of a frame comes its picture; only for designs with taps.
  async scan(count) {
    const part = await this.call("scan", count);
    return part.ended ? this.ofRays(part) : part;
  }

  ofRays(frame) {
    const { columns, rows, doubling } = this.design;
    const width = columns * doubling;
    const missing = width * rows * doubling - frame.pixels.length / 4;
    if (missing) return { ...frame, pixels: null };
    if (doubling > 1) {
      const all = new Uint32Array(frame.pixels.buffer), rays = new Uint32Array(columns * rows);
      for (let row = 0, at = 0; row < rows; row++) {
        for (let column = 0; column < columns; column++) rays[at++] = all[(row * width + column) * doubling];
      }
      frame.pixels = new Uint8Array(rays.buffer);
    }
    RayCaster.plant?.(frame.pixels, columns);
    return frame;
  }
}

// Machines with the same design and scene, which share the rows of each frame and hand over runs of one colour.
class Drawing {
  static async start(name, count = Math.max(1, Math.min(MOST_SHARES, navigator.hardwareConcurrency ?? 1))) {
    const drawing = new Drawing();
    const { design, module } = await RayCaster.model(name);
    Object.assign(drawing, { name, design, shares: Array.from({ length: count }, () => new Remote()) });
    await Promise.all(drawing.shares.map((share) => share.call("start", module, design, "")));
    return drawing;
  }

  // Return a running design of this name: the given one, or a new one that replaces it.
  static async instead(drawing, name) {
    if (drawing?.name === name) return drawing;
    drawing?.end();
    return Drawing.start(name);
  }

  end() {
    for (const share of this.shares) share.end();
  }

  // Draw a frame of a scene, or of the last scene from a camera.
  async frame({ scene = null, camera = null }) {
    const stride = this.shares.length, { columns, rows } = this.design;
    const parts = await Promise.all(
      this.shares.map((share, skipped) => share.call("draw", { scene, camera, skipped, stride })),
    );
    const pixels = new Uint8Array(4 * columns * rows);
    for (const { runs } of parts) paint(new Uint32Array(pixels.buffer), runs, columns);
    RayCaster.plant?.(pixels, columns);
    const clocks = parts.reduce((sum, part) => sum + part.clocks, this.design.first_deal);
    const runs = parts.reduce((sum, part) => sum + part.runs.length / 2, 0);
    return { pixels, words: parts[0].words, clocks, runs, milliseconds: Math.max(...parts.map((part) => part.milliseconds)) };
  }
}

// Paint runs: for each its row in the upper half of a number and its end in the lower one, and then its colour.
function paint(pixels, runs, columns) {
  let row = -1, begin = 0;
  for (let index = 0; index < runs.length; index += 2) {
    const place = runs[index], first = (place >>> 16) * columns;
    if (place >>> 16 !== row) begin = first;
    row = place >>> 16;
    pixels.fill(runs[index + 1], begin, (begin = first + (place & 0xffff)));
  }
}

// Checks as many pictures as time allows.
class Judge extends Remote {
  static async start() {
    const judge = new Judge();
    judge.busy = false;
    await judge.call("start", (await RayCaster.model("golden")).module, {});
    return judge;
  }

  // Return the differences; null while the previous picture is still being checked, or if there is no picture yet.
  async look(frame, design) {
    if (this.busy || !frame.pixels) return null;
    this.busy = true;
    try {
      return await this.call("judge", frame.words, frame.pixels, design);
    } finally {
      this.busy = false;
    }
  }
}

// A hash of a picture: FNV-1a of the words of red, green, blue and 255.
function pictureHash(pixels) {
  let hash = 2166136261;
  for (const word of new Uint32Array(pixels.buffer, pixels.byteOffset, pixels.length / 4)) {
    hash = Math.imul(hash ^ word, 16777619);
  }
  return (hash >>> 0).toString(16).padStart(8, "0");
}

function draw(canvas, pixels, design) {
  const { columns, rows } = design;
  if (canvas.width !== columns || canvas.height !== rows) {
    canvas.width = columns;
    canvas.height = rows;
  }
  const image = new ImageData(new Uint8ClampedArray(pixels.buffer, pixels.byteOffset, pixels.length), columns, rows);
  canvas.getContext("2d").putImageData(image, 0, 0);
}

// Colour the pixels that are marked as wrong.
function mark(canvas, wrong, colour) {
  const context = canvas.getContext("2d");
  context.fillStyle = colour;
  for (let index = wrong.indexOf(1); index >= 0; index = wrong.indexOf(1, index + 1)) {
    context.fillRect(index % canvas.width, Math.floor(index / canvas.width), 1, 1);
  }
}
