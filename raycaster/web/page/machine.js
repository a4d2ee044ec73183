// SPDX-License-Identifier: MIT
// A worker: the hardware, or the golden check, in WebAssembly. The page calls functions by message: it sends
// {id, call, parameters}, and gets {id, result} or {id, error}.
"use strict";

let exported, design;

// System calls of the C++ library: error output and exit; all others do nothing.
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
      throw new Error(`the simulation ended with exit code ${code}`);
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

// Turn a driver's error into an exception.
function check(error) {
  if (error) throw new Error(textAt(exported.error_text(error)));
}

const rgb = ([red, green, blue]) => (red << 16) | (green << 8) | blue;

const calls = {
  async start(module, ofDesign, program) {
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
    if (design.light) {
      check(scene.light ? exported.set_light(...scene.light.position, scene.light.quarters) : exported.clear_light());
    }
    for (let index = scene.rect.length; index < design.rectangles; index++) check(exported.disable_rectangle(index));
    check(exported.set_reflections(scene.reflections));
    exported.set_run(1);
    check(exported.commit());
  },

  look(position, basis) {
    check(exported.set_camera(...position));
    if (design.turn) check(exported.set_basis(...basis.flat()));
  },

  // Run to the next vertical sync; if a camera is given, commit it first.
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

  // Draw the rows of this share of a frame; the scene or only a camera is committed first, if given.
  draw({ scene = null, camera = null, skipped = 0, stride = 1 }) {
    const began = performance.now();
    if (scene) calls.load(scene);
    else if (camera) {
      calls.look(camera.position, camera.basis);
      check(exported.commit());
    }
    const clocks = exported.draw(skipped, stride);
    const milliseconds = performance.now() - began;
    const runs = new Uint32Array(bytes(exported.runs(), 8 * exported.run_count()).slice().buffer);
    const words = skipped ? null : bytes(exported.live_words(), 4096).slice();
    return { runs, words, clocks, milliseconds };
  },

  // Run a frame and record the ray unit of a pixel: design.taps.count numbers for each of its clocks.
  watch(column, row) {
    const { units } = design.taps;
    exported.watch(column % units, row, Math.floor(column / units));
    const frame = calls.frame();
    const samples = bytes(exported.samples(), 4 * exported.sample_count()).slice();
    return { ...frame, samples: new Uint32Array(samples.buffer) };
  },

  // Run on until `count` clocks of the monitor were received since the last call, or to the vertical sync, with which
  // the frame is complete.
  scan(count) {
    const ended = exported.scan(count) === 1;
    const received = new Uint32Array(bytes(exported.received(), 4 * exported.received_count()).slice().buffer);
    if (!ended) return { received, ended };
    const pixels = bytes(exported.pixels(), 4 * exported.pixel_count()).slice();
    const words = bytes(exported.live_words(), 4096).slice();
    return { received, ended, pixels, words };
  },

  // Compare a picture with the scene in these register words: number of wrong pixels, and a byte per pixel, 1 if wrong.
  judge(words, pixels, of) {
    bytes(exported.golden_words(), words.length).set(words);
    const { columns, rows, scale } = of;
    exported.golden_draw(
      of.engine, of.rectangles, of.materials, of.patterns, of.turn, of.light, columns, rows, of.horizon_row,
      scale, of.fraction_bits, 0, 8,
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

  // Return the correct bounces and colour of a pixel in the last picture that was judged.
  explain(column, row, columns) {
    const count = exported.golden_ray(column, row);
    const numbers = Array.from(new BigInt64Array(exported.memory.buffer, exported.golden_bounces(), 9 * count), Number);
    const bounces = Array.from({ length: count }, (_, bounce) => {
      const [winner, numerator, denominator, x, y, z, colour, quarters, shadow] = numbers.slice(9 * bounce);
      return { winner, numerator, denominator, point: [x, y, z], colour, quarters, shadow };
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
