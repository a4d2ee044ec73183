// SPDX-License-Identifier: MIT
// The hardware as seen by the page: machines in workers, and the check of their pictures.
"use strict";

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
    return { design, wasm: await RayCaster.unpack(wasm), program: text };
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
    const { design, wasm, program } = await RayCaster.model(name);
    machine.name = name;
    machine.design = design;
    await machine.call("start", wasm, design, program);
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

// Checks as many pictures as time allows.
class Judge extends Remote {
  static async start() {
    const judge = new Judge();
    judge.busy = false;
    await judge.call("start", (await RayCaster.model("golden")).wasm, {});
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
