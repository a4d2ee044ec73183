// SPDX-License-Identifier: MIT
// A worker: the hardware, or the golden check, in WebAssembly. The page calls one function at a time, by message:
// {id, call, arguments} is answered by {id, result} or {id, error}.
"use strict";

let exported, design;

// Of the system that the C++ library expects there is only where it writes its errors.
function system(module) {
  const imports = {};
  const functions = {
    fd_write(file, vectors, count, written) {
      const view = new DataView(exported.memory.buffer);
      let text = "", size = 0;
      for (let index = 0; index < count; index++) {
        const start = view.getUint32(vectors + 8 * index, true), length = view.getUint32(vectors + 8 * index + 4, true);
        text += new TextDecoder().decode(new Uint8Array(exported.memory.buffer, start, length));
        size += length;
      }
      view.setUint32(written, size, true);
      console.error(text);
      return 0;
    },
    proc_exit(code) {
      throw new Error(`the simulation ended with ${code}`);
    },
  };
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    imports[from] ??= {};
    imports[from][name] = functions[name] ?? (() => 0);
  }
  return imports;
}

function bytes(start, length) {
  return new Uint8Array(exported.memory.buffer, start, length);
}

function textAt(start) {
  const all = new Uint8Array(exported.memory.buffer);
  return new TextDecoder().decode(all.subarray(start, all.indexOf(0, start)));
}

// What the driver says to a call.
function check(error) {
  if (error) throw new Error(textAt(exported.error_text(error)));
}

const rgb = ([red, green, blue]) => (red << 16) | (green << 8) | blue;

const calls = {
  async start(wasm, ofDesign, program) {
    const module = await WebAssembly.compile(wasm);
    exported = (await WebAssembly.instantiate(module, system(module))).exports;
    design = ofDesign;
    exported._initialize?.();
    if (program) bytes(exported.program(program.length), program.length).set(new TextEncoder().encode(program));
    if (exported.start) check(exported.start());
  },

  load(scene) {
    check(exported.set_background(rgb(scene.background)));
    calls.look(scene.camera.position, scene.basis);
    scene.rect.forEach((rect, index) => {
      check(exported.set_rectangle(index, ...rect.corners[0], ...rect.corners[1], rgb(rect.colour)));
      if (design.materials) check(exported.set_mirror(index, rect.quarters));
      if (design.patterns && rect.kind) check(exported.set_pattern(index, rect.kind, rect.cell, rgb(rect.colour2)));
    });
    for (let index = scene.rect.length; index < design.rectangles; index++) check(exported.disable_rectangle(index));
    check(exported.set_reflections(scene.reflections));
    exported.set_run(1);
    check(exported.commit());
  },

  look(position, basis) {
    check(exported.set_camera(...position));
    if (design.turn) check(exported.set_basis(...basis.flat()));
  },

  // Runs to the next vertical sync; a camera is committed first.
  frame({ buttons = 0, camera = null } = {}) {
    const began = performance.now();
    if (camera) {
      calls.look(camera.position, camera.basis);
      check(exported.commit());
    }
    const clocks = exported.frame(buttons);
    const milliseconds = performance.now() - began;
    const pixels = bytes(exported.pixels(), 4 * exported.pixel_count()).slice();
    const words = bytes(exported.live_words(), 4096).slice();
    const text = new TextDecoder().decode(bytes(exported.text(), exported.text_size()));
    return { pixels, words, clocks, busy: exported.busy(), milliseconds, text };
  },

  // A frame, and what the unit that has a pixel does for it: design.taps.count numbers for each of its clocks.
  watch(column, row) {
    const { units } = design.taps;
    exported.watch(column % units, row, Math.floor(column / units));
    const frame = calls.frame();
    const samples = bytes(exported.samples(), 4 * exported.sample_count()).slice();
    return { ...frame, samples: new Uint32Array(samples.buffer) };
  },

  // How many pixels of a picture are not those of the scene in these register words, and a byte for each, 1 if so.
  judge(words, pixels, of) {
    bytes(exported.golden_words(), words.length).set(words);
    const { columns, rows, scale } = of;
    exported.golden_draw(
      of.engine, of.rectangles, of.materials, of.patterns, of.turn, columns, rows, of.horizon_row, scale,
      of.fraction_bits, 0, 8,
    );
    const golden = bytes(exported.golden_picture(), 3 * columns * rows);
    const wrong = new Uint8Array(columns * rows);
    let count = 0;
    for (let index = 0, at = 0; index < wrong.length; index++, at += 3) {
      const shown = 4 * index;
      if (golden[at] !== pixels[shown] || golden[at + 1] !== pixels[shown + 1] || golden[at + 2] !== pixels[shown + 2]) {
        wrong[index] = 1;
        count++;
      }
    }
    return { count, wrong };
  },

  // What is right for a pixel of the picture that was judged last.
  explain(column, row, columns) {
    const count = exported.golden_ray(column, row);
    const numbers = Array.from(new BigInt64Array(exported.memory.buffer, exported.golden_bounces(), 8 * count), Number);
    const bounces = Array.from({ length: count }, (_, bounce) => {
      const [winner, numerator, denominator, x, y, z, colour, quarters] = numbers.slice(8 * bounce);
      return { winner, numerator, denominator, point: [x, y, z], colour, quarters };
    });
    const channels = bytes(exported.golden_picture() + 3 * (row * columns + column), 3);
    return { bounces, colour: rgb(channels) };
  },
};

onmessage = async ({ data: { id, call, parameters } }) => {
  try {
    postMessage({ id, result: await calls[call](...parameters) });
  } catch (error) {
    postMessage({ id, error: error.message });
  }
};
