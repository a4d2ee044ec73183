// SPDX-License-Identifier: MIT
// A board with a serial port: the words of a scene as in raycaster/program.py, in frames as in
// raycaster/serial_frames.py.
"use strict";

const RayCasterBoard = (() => {
  const FLAG = 0x7e, ESCAPE = 0x7d, ESCAPED = 0x20, LEAD = 0xff;
  const PATIENCE = 500, ATTEMPTS = 3; // ms for an answer, and frames that are sent for one
  const SHOWN = 3000; // ms within which a new scene must be drawn

  function check(bytes) {
    let crc = 0xffffffff;
    for (const byte of bytes) {
      crc ^= byte;
      for (let bit = 0; bit < 8; bit++) crc = (crc >>> 1) ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc >>> 0;
  }

  const bytesOf = (words) => words.flatMap((word) => [0, 8, 16, 24].map((low) => (word >>> low) & 0xff));
  const access = (address, words, read = 0) =>
    [(((words.length ? 1 << 31 : 0) | ((words.length || read) << 16) | address) >>> 0), ...words];

  function framed(words) {
    const plain = bytesOf(words);
    const sent = [...plain, ...bytesOf([check(plain)])].flatMap((byte) =>
      byte === FLAG || byte === ESCAPE ? [ESCAPE, byte ^ ESCAPED] : [byte]);
    return [FLAG, ...sent, FLAG];
  }

  // The words between two flags, or null if they are no frame.
  function unframed(held) {
    const plain = [];
    for (let at = 0; at < held.length; at++) plain.push(held[at] === ESCAPE ? held[++at] ^ ESCAPED : held[at]);
    if (plain.length < 4 || plain.length % 4) return null;
    const words = [];
    for (let at = 0; at < plain.length; at += 4)
      words.push((plain[at] | (plain[at + 1] << 8) | (plain[at + 2] << 16) | (plain[at + 3] << 24)) >>> 0);
    return words.pop() === check(plain.slice(0, -4)) ? words : null;
  }

  const register = (name) => RayCaster.board.registers[name];

  function pack(name, values) {
    let word = 0;
    for (const [field, value] of Object.entries(values)) {
      const [low, width] = register(name).fields[field];
      word |= (value & ((1 << width) - 1)) << low;
    }
    return word >>> 0;
  }

  const unpack = (name, word) => Object.fromEntries(Object.entries(register(name).fields).map(
    ([field, [low, width]]) => [field, Math.floor(word / 2 ** low) % 2 ** width]));

  // Addresses and words of a scene; the last one commits.
  function sceneWords(scene, basis, design) {
    const pairs = [];
    const write = (name, values, offset = 0) => pairs.push([register(name).address + offset, pack(name, values)]);
    const point = ([x, y, z]) => ({ x, y, z }), colour = ([red, green, blue]) => ({ red, green, blue });
    write("background", colour(scene.background));
    write("camera", point(scene.camera.position));
    if (design.turn) ["forward", "right", "up"].forEach((name, index) => write(name, point(basis[index])));
    if (design.light) write("light",
      scene.light ? { ...point(scene.light.position), shade: scene.light.quarters, on: 1 } : { on: 0 });
    for (let index = 0; index < design.rectangles; index++) {
      const rect = scene.rect[index], entry = (part, values) => write(`rectangle[0].${part}`, values, 4 * index);
      if (!rect) {
        entry("surface", { enable: 0 });
        continue;
      }
      rect.corners.forEach((corner, at) => entry(`corner_${at}`, point(corner)));
      if (design.patterns)
        entry("pattern", { ...colour(rect.colour2), kind: rect.kind, cell: Math.log2(rect.cell) - 3 });
      entry("surface", { enable: 1, ...colour(rect.colour), mirror: rect.quarters });
    }
    write("control", { run: 1, commit: 1, reflections: scene.reflections });
    return pairs;
  }

  function writes(pairs) {
    const commit = pairs.at(-1), runs = [];
    for (const [address, word] of pairs.slice(0, -1).sort(([one], [other]) => one - other)) {
      const run = runs.at(-1);
      if (run && run.address + run.words.length === address) run.words.push(word);
      else runs.push({ address, words: [word] });
    }
    return [...runs.flatMap(({ address, words }) => access(address, words)), ...access(commit[0], [commit[1]])];
  }

  const frame = (scene, basis, design) => [LEAD, ...framed(writes(sceneWords(scene, basis, design)))];

  // What the design says of itself, or an error.
  function designOf(words) {
    const { board } = RayCaster, of = (name) => unpack(name, words[register(name).address]);
    const engine = of("engine"), name = board.engines[engine.engine];
    if (of("id").magic !== board.id || of("version").major !== board.major || !name)
      throw new Error("what answers is no ray tracer of this version");
    if (engine.fixed) throw new Error("the design has a scene built in");
    const rectangles = of("table").rectangles || of("size").rectangles;
    return { ...engine, name, rectangles, draws: board.draws.includes(name) };
  }

  // Wait until a frame of the scene that was sent is drawn, which has too many runs for some lists.
  async function shown(request) {
    const end = Date.now() + SHOWN;
    const read = async (name) => {
      const asked = access(register(name).address, [], 1);
      return unpack(name, (await request([LEAD, ...framed(asked)], asked[0], 2))[0]);
    };
    const wait = async (holds) => {
      while (!(await holds())) if (Date.now() > end) throw new Error(`the board has drawn no frame of it for ${SHOWN / 1000} s`);
    };
    await wait(async () => !(await read("control")).commit);
    // A frame of the scene before may have set it.
    const clear = writes([[register("frames.status").address, pack("frames.status", { list_full: 1 })]]);
    await request([LEAD, ...framed(clear)], clear[0], 1);
    const { drawn } = await read("frames.counts"), isFull = async () => (await read("frames.status")).list_full;
    await wait(async () => (await isFull()) || (await read("frames.counts")).drawn !== drawn);
    if (await isFull()) throw new Error("a frame of it has more runs than the board's list; build it with a longer LIST");
  }

  // Send a scene to a port of Web Serial; return the design.
  async function send(port, scene, basis) {
    await port.open({ baudRate: RayCaster.board.baud });
    const reader = port.readable.getReader(), writer = port.writable.getWriter();
    let held = [], hear = () => {};
    const listening = (async () => {
      for (let { value, done } = await reader.read(); !done; { value, done } = await reader.read())
        for (const byte of value) {
          if (byte !== FLAG) {
            held.push(byte);
            continue;
          }
          const words = unframed(held);
          held = [];
          if (words) hear(words);
        }
    })();
    const request = async (bytes, first, length) => {
      for (let attempt = 0; attempt < ATTEMPTS; attempt++) {
        const answer = new Promise((resolve) => {
          hear = (words) => words[0] === first && words.length === length && resolve(words.slice(1));
          setTimeout(() => resolve(null), PATIENCE);
        });
        await writer.write(new Uint8Array(bytes));
        const words = await answer;
        if (words) return words;
      }
      throw new Error(`no answer at ${RayCaster.board.baud} baud`);
    };
    try {
      const count = register("table").address + 1, [asked] = access(0, [], count);
      const design = designOf(await request([LEAD, ...framed([asked])], asked, 1 + count));
      if (scene.rect.length > design.rectangles)
        throw new Error(`${scene.rect.length} rectangles, but the board's design holds ${design.rectangles}`);
      const lacks = Object.keys(scene.needs).find((feature) => scene.needs[feature] && !design[feature]);
      if (lacks) throw new Error(`the board's design has no ${lacks}; build it with ${lacks.toUpperCase()}=1`);
      if (scene.reflections > design.reflections)
        throw new Error(`the room has ${counted(scene.reflections, "reflection")}, but the board's design computes at ` +
          `most ${design.reflections}`);
      const [commit] = access(register("control").address, [0]);
      await request(frame(scene, basis, design), commit, 1);
      if (design.draws) await shown(request);
      return design;
    } finally {
      await reader.cancel();
      await listening;
      reader.releaseLock();
      writer.releaseLock();
      await port.close();
    }
  }

  return { framed, frame, send };
})();
