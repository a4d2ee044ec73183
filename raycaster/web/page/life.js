// SPDX-License-Identifier: MIT
// A pixel's life, reconstructed from its ray unit's signals in each clock.
//
// Signals and events are those of the project's debugger (raycaster/debug/probes). A probe says which taps of the design hold a
// quantity, at which event of the control, and how many clocks after it.
"use strict";

const RayCasterLife = (() => {
  const LIT = -1, DARK_SIDE = -2;
  // Steps of the control for each tested rectangle, in order, by kind of event.
  const STEPS = { load: "steps_load_divider", store: "steps_store_quotient", write: "steps_write_z_buf" };

  // The taps of a design (see tap_facts), and their values.
  class Recording {
    constructor(taps, samples) {
      this.taps = taps;
      this.samples = samples;
      this.clocks = samples.length / taps.count;
    }

    control(name, clock) {
      return this.samples[clock * this.taps.count + this.taps.controls[name]];
    }

    // Values of a probe at a clock; null after the end of the recording.
    values(probe, clock) {
      if (clock >= this.clocks) return null;
      return probe.taps.map((tap) => {
        const word = this.samples[clock * this.taps.count + tap];
        return probe.signed ? word | 0 : word;
      });
    }

    probe(quantity) {
      return this.taps.probes.find((probe) => probe.quantity === quantity);
    }
  }

  // Events of the rectangles that a ray was tested against before its end: each passes the unit's steps in order, and
  // may wait for another one between two of them.
  function followed(recording, tried, bounce, end) {
    const { controls } = recording.taps, events = [];
    const kinds = Object.keys(STEPS).filter((kind) => STEPS[kind] in controls);
    const waiting = { find: [], ...Object.fromEntries(kinds.map((kind) => [kind, []])) };
    for (let clock = tried[0]?.clock ?? end; clock < end; clock++) {
      const strobe = (name) => recording.control(name, clock) === 1;
      const enter = (kind, rectangle) => {
        waiting[kind].push(rectangle);
        events.push({ kind, clock, bounce, rectangle });
      };
      if (tried[0]?.clock === clock) enter("find", tried.shift().rectangle);
      for (const [step, kind] of [...kinds.entries()].reverse()) {
        const before = waiting[kinds[step - 1] ?? "find"];
        if (strobe(STEPS[kind]) && before.length) enter(kind, before.shift());
      }
      if ("early_out" in controls && strobe("early_out")) waiting.load.pop();
    }
    return events;
  }

  // Events of the rays, and of the rectangles that they were tested against. In a design with a light, "shade" is the
  // verdict on a shadow ray and one rectangle: if it sets the unit's flag, that rectangle shades the hit point.
  function eventsOf(recording) {
    const events = [{ kind: "start", clock: 0, bounce: 0 }, { kind: "ray", clock: 0, bounce: 0 }];
    const hasLight = "steps_write_shadow" in recording.taps.controls;
    let bounce = 0, atHand = null, tried = [], shadows = [];
    for (let clock = 0; clock < recording.clocks; clock++) {
      const strobe = (name) => recording.control(name, clock) === 1;
      if (strobe("steps_find_intersection") && atHand !== null) {
        if (hasLight && strobe("from_light")) shadows.push(atHand);
        else tried.push({ clock, rectangle: atHand });
      }
      if (hasLight && strobe("steps_write_shadow")) {
        events.push({ kind: "shade", clock, bounce, shades: shadows.shift() });
      }
      if (strobe("rects_fetch")) atHand = recording.control("rects_index", clock);
      if (strobe("steps_add_colour")) {
        events.push(...followed(recording, tried, bounce, clock), { kind: "blend", clock, bounce });
        if (strobe("steps_store_ray")) events.push({ kind: "ray", clock, bounce: bounce + 1 });
        bounce++;
        tried = [];
        shadows = [];
      }
      if (strobe("done")) events.push({ kind: "done", clock, bounce: Math.max(0, bounce - 1) });
    }
    return events;
  }

  // Return whether the rectangle offered at a clock is kept as the nearest so far, and whether there is any nearest.
  function verdict(recording, clock) {
    const found = recording.probe("found"), nearest = recording.probe("nearest t") ?? recording.probe("nearest");
    const kept = (at) => [recording.values(found, at), recording.values(nearest, at)];
    const before = kept(clock), after = kept(clock + 1);
    const isFound = after[0]?.[0] === 1;
    return { kept: isFound && String(before) !== String(after), found: isFound };
  }

  // Hit point of a ray of the exact engine, E + D n / e with the eye E and the slope D, as numerators over e.
  function pointOnRay(bounce, magnitudes, [n, e]) {
    const { eye, signs } = bounce.values;
    return eye.map((start, axis) => start * e + (signs[axis] ? -1 : 1) * magnitudes[axis] * n);
  }

  /**
   * Reconstructs a pixel's life from recorded samples.
   * @param {object} taps the design's taps, from tap_facts in taps.py
   * @param {Uint32Array} samples taps.count numbers for each clock in which the pixel was computed
   * @param {number} fractionBits fraction bits of the seed engine; 0 for the exact engine
   * @returns {{clocks, bounces, values}} values: values of the pixel, by quantity. bounces: {slope, values, tried,
   *   winner, distance, point, denominator, colour, shadow} of the camera's ray and of each reflection: tried is a list
   *   of {rectangle, values, kept, found} (kept: as the nearest so far; found: a nearest exists by then), winner the
   *   rectangle seen or -1, distance the quantity that decided (t as [n, e], or [depth]), point the coordinates over
   *   the denominator, colour a number. In a design with a light, shadow is as in golden.cpp: the rectangle that shades
   *   the point, or LIT or DARK_SIDE
   */
  function read(taps, samples, fractionBits = 0) {
    const recording = new Recording(taps, samples);
    const life = { clocks: recording.clocks, bounces: [], values: {} };
    if (!recording.clocks) return life;
    for (const { kind, clock, bounce, rectangle, shades } of eventsOf(recording)) {
      const ray = (life.bounces[bounce] ??= { values: {}, tried: [] });
      if (kind === "shade") {
        const [before, after] = [clock, clock + 1].map((at) => recording.values(recording.probe("light"), at)?.[0]);
        if (!before && after) ray.shades = shades;
      }
      let values = kind === "done" ? life.values : ray.values;
      if (rectangle !== undefined) {
        let one = ray.tried.find((other) => other.rectangle === rectangle);
        if (!one) ray.tried.push((one = { rectangle, values: {}, kept: false, found: false }));
        if (kind === "write") Object.assign(one, verdict(recording, clock));
        values = one.values;
      }
      for (const probe of taps.probes) {
        if (probe.event === kind) values[probe.quantity] = recording.values(probe, clock + probe.late);
        // The shadow ray stays as it was aimed until the colour is added.
        if (probe.event === "aimed" && kind === "blend") values[probe.quantity] = recording.values(probe, clock);
      }
    }
    // Don't care what the unit finds after its ray has ended.
    life.bounces = life.bounces.filter((bounce) => bounce.values["ended before"]?.[0] === 0);
    const magnitudes = life.bounces[0]?.values["slope, magnitudes"];
    for (const bounce of life.bounces) {
      const seen = bounce.tried.findLast((one) => one.kept);
      bounce.winner = seen ? seen.rectangle : -1;
      const { signs } = bounce.values;
      bounce.slope = magnitudes.map((magnitude, axis) => (signs[axis] && magnitude ? -magnitude : magnitude));
      [bounce.colour] = bounce.values["colour seen"];
      if (!seen) continue;
      bounce.distance = seen.values["nearest t"] ?? seen.values.nearest;
      const isExact = "nearest t" in seen.values;
      bounce.denominator = isExact ? bounce.distance[1] : 1 << fractionBits;
      const { light } = bounce.values;
      if (light) bounce.shadow = !light[1] ? DARK_SIDE : light[0] ? (bounce.shades ?? null) : LIT;
      bounce.point = isExact ? pointOnRay(bounce, magnitudes, bounce.distance) : seen.values["nearest point"];
    }
    return life;
  }

  return { read, LIT, DARK_SIDE };
})();
