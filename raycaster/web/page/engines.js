// SPDX-License-Identifier: MIT
// The tab that compares the seed engine with the exact engine.
"use strict";

tabs.engines = {
  async open() {
    const selects = { scene: find("engines-scene"), fraction: find("engines-fraction") };
    fillScenes(selects.scene);
    fill(selects.fraction, RayCaster.seed.fractions.map(String), "0");
    const box = find("engines-mark");
    const canvases = { seed: find("engines-seed"), exact: find("engines-exact") };
    const statuses = { seed: find("engines-seed-status"), exact: find("engines-exact-status") };
    const judge = await Judge.start();
    const machines = {}, drawn = {};
    let differs = null;

    const paint = () => {
      for (const [side, frame] of Object.entries(drawn)) draw(canvases[side], frame.pixels, machines[side].design);
      if (differs && box.checked) mark(canvases.seed, differs.wrong, "#ff00ff");
    };

    const compute = async (side, model) => {
      statuses[side].textContent = "computing";
      const machine = (machines[side] = await Machine.instead(machines[side], model));
      const name = selects.scene.value;
      await machine.call("load", readScene(sceneText(name), name, machine.design.rectangles));
      drawn[side] = await machine.frame();
    };

    const report = async (side, more) => {
      const { design } = machines[side];
      const { count } = await judge.look(drawn[side], design);
      const frame = drawn[side];
      const parts = [
        `${side} engine`, `computed in ${counted(frame.busy, "clock")}`, ...more,
        `${counted(count, "pixel")} different from its own model`,
      ];
      statuses[side].textContent = parts.join(", ");
      return { hash: pictureHash(frame.pixels), wrong: count };
    };

    const all = async () => {
      RayCaster.state.engines = {};
      differs = null;
      const fraction = selects.fraction.value, error = refusal(readScene(sceneText(selects.scene.value), ""));
      canvases.seed.hidden = error !== "";
      if (error) {
        delete drawn.seed;
        statuses.seed.textContent = error;
        await compute("exact", "exact");
      } else {
        await Promise.all([compute("exact", "exact"), compute("seed", `seed-${fraction}`)]);
      }
      const exact = await report("exact", []);
      if (error) {
        paint();
        RayCaster.state.engines = { done: true, fraction, exact, seed: { error } };
        return;
      }
      // Compare the seed engine's picture with the correct picture for the exact engine's registers.
      differs = await judge.call("judge", drawn.exact.words, drawn.seed.pixels, machines.exact.design);
      const share = ((100 * differs.count) / differs.wrong.length).toFixed(2);
      const seed = await report("seed", [
        `${counted(differs.count, "pixel")} (${share}%) different from the exact engine`,
      ]);
      paint();
      RayCaster.state.engines = { done: true, fraction, exact, seed, differs: differs.count };
    };

    const ask = latest("engines", all);
    selects.scene.addEventListener("change", ask);
    selects.fraction.addEventListener("change", ask);
    box.addEventListener("change", paint);
    ask();
    return { run: followRoom(selects.scene, ask) };
  },
};
