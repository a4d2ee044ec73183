// SPDX-License-Identifier: MIT
// Changes to the text of a scene file: one value or one rectangle at a time. All else stays, with its comments.
"use strict";

const RayCasterText = (() => {
  // Find the end of the value that begins at an offset, before blanks and a comment.
  function valueEnd(text, start) {
    let depth = 0, quote = "", end = start;
    for (let at = start; at < text.length; at++) {
      const character = text[at];
      if (quote) {
        if (character === "\\" && quote === '"') at++;
        else if (character === quote) quote = "";
      } else if (character === '"' || character === "'") quote = character;
      else if (character === "[" || character === "{") depth++;
      else if (character === "]" || character === "}") depth--;
      else if (character === "#") {
        if (depth <= 0) break;
        at = lineEnd(text, at) - 1;
      } else if (character === "\n" && depth <= 0) break;
      if (!/\s/.test(text[at] ?? "")) end = at + 1;
    }
    return end;
  }

  function lineEnd(text, at) {
    const end = text.indexOf("\n", at);
    return end < 0 ? text.length : end;
  }

  /**
   * Finds the tables of a scene file, whether the file is correct or not.
   * @param {string} text the file
   * @returns {{name, start, end, keys}[]} the first is the part without a heading, with the name "". Offsets of the
   *   heading's line and of the next heading's; keys: {line, start, end} by key, of its line and of its value
   */
  function tables(text) {
    const found = [{ name: "", start: 0, end: text.length, keys: {} }];
    for (let at = 0; at < text.length; at++) {
      let end = lineEnd(text, at);
      const line = text.slice(at, end);
      const heading = /^\s*\[+\s*([\w-]+)\s*\]+/.exec(line), key = /^\s*([\w-]+)\s*=[ \t]*/.exec(line);
      if (heading) {
        found.at(-1).end = at;
        found.push({ name: heading[1], start: at, end: text.length, keys: {} });
      } else if (key) {
        const start = at + key[0].length, valueStop = valueEnd(text, start);
        found.at(-1).keys[key[1]] = { line: at, start, end: valueStop };
        end = lineEnd(text, valueStop);
      }
      at = end;
    }
    return found;
  }

  // Return a table by name, and by number among those of this name; undefined if there is none.
  function table(text, name, index = 0) {
    return tables(text).filter((one) => one.name === name)[index];
  }

  // Write a value as in a scene file.
  function valueText(value) {
    if (Array.isArray(value)) return `[${value.map(valueText).join(", ")}]`;
    return typeof value === "string" ? JSON.stringify(value) : String(value);
  }

  // Return the text with a value changed, added, or removed if it is null.
  function set(text, name, index, key, value) {
    const found = table(text, name, index);
    if (!found) return text;
    const old = found.keys[key];
    if (value === null) {
      return old ? text.slice(0, old.line) + text.slice(lineEnd(text, old.end) + 1) : text;
    }
    if (old) return text.slice(0, old.start) + valueText(value) + text.slice(old.end);
    const last = Math.max(name ? found.start : 0, ...Object.values(found.keys).map(({ end }) => end));
    const at = lineEnd(text, last);
    return `${text.slice(0, at)}\n${key} = ${valueText(value)}${text.slice(at)}`;
  }

  // Return the text with a table added: at the end, or below another one.
  function add(text, heading, values, after = null) {
    const lines = Object.entries(values).map(([key, value]) => `${key} = ${valueText(value)}\n`).join("");
    const at = after ? after.end : text.length;
    const before = text.slice(0, at).trimEnd(), rest = text.slice(at);
    return `${before}\n\n${heading}\n${lines}${rest ? `\n${rest}` : ""}`;
  }

  function remove(text, name, index = 0) {
    const found = table(text, name, index);
    return found ? text.slice(0, found.start) + text.slice(found.end) : text;
  }

  // Return the text with a rectangle repeated below itself.
  function duplicate(text, index) {
    const { start, end } = table(text, "rect", index);
    const copy = text.slice(start, end).trimEnd(), rest = text.slice(end);
    return `${text.slice(0, end).trimEnd()}\n\n${copy}\n${rest ? `\n${rest}` : ""}`;
  }

  const lineOf = (text, at) => text.slice(0, at).split("\n").length;

  // Return the number of the line, from 1, to which an error of RayCasterScene.read refers; 1 if it names none.
  function errorLine(text, error) {
    const number = /^[^:]*: (?:is|has) .*?\bat line (\d+)/.exec(error);
    if (number) return Number(number[1]);
    const place = /^[^:]*: (\w+)(?:\[(\d+)\])?(?: \("(?:[^"\\]|\\.)*"\))?[ .]?(\w+)?/.exec(error) ?? [];
    const [, name, index, key] = place;
    const found = table(text, name, Number(index ?? 0));
    if (found) return lineOf(text, found.keys[key]?.line ?? found.start);
    return lineOf(text, table(text, "").keys[name]?.line ?? 0);
  }

  return { tables, table, set, add, remove, duplicate, lineOf, errorLine };
})();
