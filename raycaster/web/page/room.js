// SPDX-License-Identifier: MIT
// The room: the text of a scene file, its history, and its form in the page's address.
"use strict";

const MOST_UNDO = 200;
const LINK = "#room=";

async function piped(bytes, stream) {
  return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream)).arrayBuffer());
}

// Write a text as the end of an address.
async function packText(text) {
  const bytes = await piped(new TextEncoder().encode(text), new CompressionStream("deflate-raw"));
  const letters = btoa(String.fromCharCode(...bytes));
  return letters.replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

async function unpackText(letters) {
  const bytes = atob(letters.replaceAll("-", "+").replaceAll("_", "/"));
  const packed = Uint8Array.from(bytes, (character) => character.charCodeAt(0));
  return new TextDecoder("utf-8", { fatal: true }).decode(await piped(packed, new DecompressionStream("deflate-raw")));
}

// The edited scene. `scene` is the last correct one, and `error` says what is wrong with the text since.
class Room extends EventTarget {
  constructor() {
    super();
    Object.assign(this, { name: "", text: "", scene: null, error: "", before: [], after: [], version: 0, selected: -1 });
  }

  // Begin with another text.
  open(text, name) {
    this.name = name;
    this.selected = -1;
    this.keep();
    this.show(text);
  }

  // Keep the present text for undo. A gesture keeps it once, at its beginning.
  keep() {
    if (!this.text || this.before.at(-1) === this.text) return;
    this.before.push(this.text);
    if (this.before.length > MOST_UNDO) this.before.shift();
    this.after = [];
  }

  // Replace the text in one step.
  change(text) {
    if (text === this.text) return;
    this.keep();
    this.show(text);
  }

  show(text) {
    this.text = text;
    this.error = "";
    try {
      const most = Math.max(...RayCaster.walk.models.map(({ rectangles }) => rectangles));
      const scene = readScene(text, this.name || "room", most);
      if (!modelOf(scene)) throw new Error(`${this.name}: no model of this page draws ${counted(scene.rect.length, "rectangle")}`);
      this.scene = scene;
      this.version++;
      if (this.selected >= scene.rect.length) this.selected = -1;
    } catch (error) {
      this.error = error.message;
    }
    this.dispatchEvent(new Event("change"));
  }

  undo() {
    if (this.before.length) this.step(this.before, this.after);
  }

  redo() {
    if (this.after.length) this.step(this.after, this.before);
  }

  step(from, to) {
    to.push(this.text);
    this.show(from.pop());
  }

  select(index) {
    if (index === this.selected) return;
    this.selected = index;
    this.dispatchEvent(new Event("select"));
  }

  get rect() {
    return this.scene?.rect[this.selected] ?? null;
  }

  // Change a value; null takes it away.
  set(name, index, key, value) {
    this.show(RayCasterText.set(this.text, name, index, key, value));
  }

  get isPackaged() {
    return Object.values(RayCaster.scenes).includes(this.text);
  }
}

RayCaster.room = new Room();
