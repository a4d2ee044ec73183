// SPDX-License-Identifier: MIT
// Scene files in the browser: RayCasterScene.read returns the scene, or an error line for the same place and with the
// same expectation as `load_scene` in raycaster/scene.py. Rules and messages come from there, through
// raycaster/web/site.py; this file implements each kind of rule. Syntax errors have the line and the words of
// vendor/smol-toml.js.
"use strict";

const RayCasterScene = (() => {
  const BASIS_SCALE = 256; // Length of a vector in a camera's basis.
  const UNTURNED = [[BASIS_SCALE, 0, 0], [0, BASIS_SCALE, 0], [0, 0, BASIS_SCALE]];

  // TOML integers are BigInts until the scene has been checked; TOML floats are Numbers.
  const isNumber = (value) => typeof value === "bigint" || typeof value === "number";
  const isTable = (value) => typeof value === "object" && !Array.isArray(value) && !(value instanceof Date);

  // Tests of a value, by kind of rule; same names as the functions in raycaster/scene.py.
  const HOLDS = {
    whole: (value, { lowest, highest }) => typeof value === "bigint" && value >= lowest && value <= highest,
    items: (value, { count }) => Array.isArray(value) && (count === null ? value.length > 0 : value.length === count),
    choice: (value, { choices, whole }) =>
      typeof value === "bigint" ? choices.includes(Number(value)) : !whole && choices.includes(value),
    angle: (value, { largest }) => isNumber(value) && value >= -largest && value <= largest,
    colour: (value, { pattern }) => typeof value === "string" && new RegExp(`^(?:${pattern})$`).test(value),
    plane: ([first, second]) => first.some((coordinate, axis) => coordinate === second[axis]),
  };

  const fill = (template, values) => template.replace(/\{(\w+)\}/g, (_, name) => values[name]);

  // Resolve a part of the model's JSON schema: follow references, and take the value of "value or null".
  function resolve(part, schema) {
    const rule = part.anyOf?.[0] ?? part;
    return rule.$ref ? schema.model.$defs[rule.$ref.split("/").pop()] : rule;
  }

  // A value as in a scene file, for the end of an error message; the page needs no more of a table.
  function valueText(value) {
    if (Array.isArray(value)) return `[${value.map(valueText).join(", ")}]`;
    if (typeof value === "number" && Number.isInteger(value)) return `${value}.0`;
    if (typeof value === "string" || value instanceof Date) return JSON.stringify(value);
    return isTable(value) ? "a table" : `${value}`;
  }

  function given(value, schema) {
    const text = valueText(value);
    return text.length <= schema.longest_shown ? `, not ${text}` : "";
  }

  // The keys and indices of a mistake, with the rectangle's name: rect[0] ("floor") corners[1].
  function placeText(place, contents) {
    let text = "";
    let separator = "";
    place.forEach((key, depth) => {
      if (typeof key === "number") text += `[${key}]`;
      else text += separator + (/^[A-Za-z0-9_-]+$/.test(key) ? key : JSON.stringify(key));
      separator = ".";
      if (depth === 1 && place[0] === "rect" && typeof contents.rect[key].name === "string") {
        text += ` (${JSON.stringify(contents.rect[key].name)})`;
        separator = " ";
      }
    });
    return text;
  }

  // All mistakes in a value, in pydantic's order: a list of {place, expected, isKey}; isKey is true if the key itself
  // is the mistake.
  function mistakes(value, part, place, schema) {
    const rule = resolve(part, schema);
    const wrong = (expected) => [{ place, expected: expected + given(value, schema) }];
    const broken = (after) =>
      (rule.checks ?? []).find((check) => check.after === after && !HOLDS[check.kind](value, check));
    if (broken(false)) return wrong(broken(false).expected);
    if (rule.type === "object" && !isTable(value)) return wrong(schema.complaints.model_type);
    if (rule.type === "string" && typeof value !== "string") return wrong(schema.complaints.string_type);
    let within = [];
    if (rule.type === "object") within = mistakesOfTable(value, rule, place, schema);
    if (rule.type === "array") {
      const partOf = (index) => rule.prefixItems?.[index] ?? rule.items;
      within = value.flatMap((item, index) => mistakes(item, partOf(index), [...place, index], schema));
    }
    if (within.length) return within;
    if (broken(true)) return wrong(broken(true).expected);
    if (rule.properties?.pattern) {
      const pattern = value.pattern ?? rule.properties.pattern.default;
      const isPlain = pattern === schema.patterns[0];
      if (!isPlain && !("colour2" in value)) return wrong(fill(schema.complaints.no_colour2, { pattern }));
      const key = schema.pattern_keys.find((one) => one in value);
      if (isPlain && key) return wrong(fill(schema.complaints.no_pattern, { key }));
    }
    return [];
  }

  function mistakesOfTable(table, rule, place, schema) {
    const keys = Object.keys(rule.properties);
    const ofKnown = keys.flatMap((key) => {
      if (key in table) return mistakes(table[key], rule.properties[key], [...place, key], schema);
      return rule.required.includes(key) ? [{ place: [...place, key], expected: schema.complaints.missing }] : [];
    });
    const expected = fill(schema.complaints.extra_forbidden, { keys: keys.join(", ") });
    const unknown = Object.keys(table).filter((key) => !keys.includes(key));
    return [...ofKnown, ...unknown.map((key) => ({ place: [...place, key], expected, isKey: true }))];
  }

  function syntaxComplaint(error, text, schema) {
    const [said] = error.message.replace("Invalid TOML document: ", "").split("\n");
    if (!error.line) return `is not TOML: ${said}`;
    const line = text.split("\n")[error.line - 1].trim();
    // With [rect] in some places, a table is declared twice or is not a list.
    const reason = /^\[+rect\]+/.test(line) ? schema.complaints.heading : said;
    const shown = line.length <= schema.longest_shown ? `: ${line}` : "";
    return fill(schema.complaints.syntax, { number: error.line, line: shown, reason });
  }

  const channels = (colour) =>
    typeof colour === "string" ? [1, 3, 5].map((digit) => parseInt(colour.slice(digit, digit + 2), 16)) : colour;

  const rounded = (value) => Math.round(value) + 0; // + 0 turns -0 into 0.

  /**
   * Computes the camera's forward, right and up as in the registers: integers, with vectors of length 256. Equal to
   * Camera.basis, except that halves are rounded up.
   * @param {number} yaw yaw in degrees; pitch and roll too
   * @returns {number[][]} three vectors of x, y, z
   */
  function basis(yaw, pitch, roll) {
    const angles = [yaw, pitch, roll].map((angle) => angle * (Math.PI / 180));
    const [[cy, sy], [cp, sp], [cr, sr]] = angles.map((angle) => [Math.cos(angle), Math.sin(angle)]);
    const vectors = [
      [cy * cp, sy * cp, sp],
      [-sy * cr - cy * sp * sr, cy * cr - sy * sp * sr, cp * sr],
      [sy * sr - cy * sp * cr, -cy * sr - sy * sp * cr, cp * cr],
    ];
    return vectors.map((vector) => vector.map((part) => rounded(part * BASIS_SCALE)));
  }

  // Complete a correct value: with the defaults of its tables' keys, and Numbers instead of BigInts.
  function filled(value, part, schema) {
    const rule = resolve(part, schema);
    if (typeof value === "bigint") return Number(value);
    if (Array.isArray(value)) return value.map((item) => filled(item, rule.items ?? {}, schema));
    if (rule.type !== "object") return value;
    return Object.fromEntries(Object.entries(rule.properties).map(([key, { default: usual, ...property }]) =>
      [key, key in value ? filled(value[key], property, schema) : usual]));
  }

  function built(contents, schema) {
    const { background, camera, light, rect, ...rest } = filled(contents, schema.model, schema);
    const usual = resolve(schema.model.properties.rect.items, schema).properties;
    const turned = basis(camera.yaw, camera.pitch, camera.roll).flat().join() !== UNTURNED.flat().join();
    return {
      ...rest,
      background: channels(background),
      camera,
      light: light && { position: light.position, quarters: 4 * light.shade },
      rect: rect.map(({ name, corners, colour, mirror, pattern, colour2, cell }) => ({
        name,
        corners,
        colour: channels(colour),
        quarters: 4 * mirror,
        kind: schema.patterns.indexOf(pattern),
        cell,
        colour2: channels(colour2 ?? "#000000"),
      })),
      needs: {
        turn: turned,
        materials: rect.some(({ mirror }) => mirror !== usual.mirror.default),
        patterns: rect.some(({ pattern }) => pattern !== usual.pattern.default),
        light: light !== null,
      },
    };
  }

  /**
   * Reads a scene file.
   * @param {string|ArrayBuffer} source text or bytes of the file
   * @param {string} name name of the file, for the error
   * @param {object} schema schema from raycaster/web/site.py
   * @param {number} [rectangles] number of rectangles that the hardware holds
   * @returns {{scene: ?object, error: ?string}} one of the two is null. Scene: title, rows, reflections, background,
   *   camera {position, yaw, pitch, roll}, light {position, quarters} or null, rect [{name, corners, colour, quarters,
   *   kind, cell, colour2}] and needs {turn, materials, patterns, light}; colours are [r, g, b], quarters are 0..4 (a
   *   mirror's reflectivity, a light's shade), kind is the register code.
   */
  function read(source, name, schema, rectangles = Infinity) {
    const refuse = (complaint) => ({ scene: null, error: `${name}: ${complaint}` });
    let text = source;
    try {
      if (typeof source !== "string") text = new TextDecoder("utf-8", { fatal: true }).decode(source);
    } catch {
      return refuse(schema.complaints.encoding);
    }
    text = text.replace(/^\ufeff/, "").replace(/\r\n?/g, "\n");
    let contents;
    try {
      contents = SmolToml.parse(text, { integersAsBigInt: true });
    } catch (error) {
      return refuse(syntaxComplaint(error, text, schema));
    }
    const found = mistakes(contents, schema.model, [], schema);
    // A mistyped key also leaves the right one missing; report the mistyped one.
    const first = found.find((mistake) => mistake.isKey) ?? found[0];
    if (first) return refuse(`${placeText(first.place, contents)}: ${first.expected}`);
    const count = contents.rect.length;
    const most = schema.most_rectangles;
    const tooMany = schema.complaints[count > most ? "far_too_many" : "too_many"];
    if (count > rectangles) return refuse(fill(tooMany, { count, rectangles, most, option: `--rectangles ${count}` }));
    return { scene: built(contents, schema), error: null };
  }

  return { basis, read };
})();
