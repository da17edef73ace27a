"use strict";
// Plots that zoom, drawn by uPlot when their button is pressed: drag, pinch, buttons or keys. The drawn figures stay.
(function () {
  const POINT = "#1d4f80", BAND = "rgba(29,79,128,0.25)", QUIET = "#5f5f5f", MARK = "#a3123a";
  const DEEPEST = 2000; // the narrowest range is this part of the whole
  const MOVES = [
    ["+", "Zoom in", 0.5, 0], ["\u2212", "Zoom out", 2, 0], ["\u25c0", "Earlier", 1, -0.5], ["\u25b6", "Later", 1, 0.5],
    ["Whole", "Show the whole range", Infinity, 0],
  ];
  const KEYS = { "+": 0, "=": 0, "-": 1, ArrowLeft: 2, ArrowRight: 3, 0: 4, Home: 4 };

  const signed = (text) => text.replace("-", "\u2212");
  const short = (value) => (value === null || value === undefined ? "" : signed(String(Number(value.toPrecision(6)))));

  const brief = (value) => signed(String(Number(value.toPrecision(4))));

  // As many decimals as tell neighbours apart.
  function ticks(plot, splits) {
    const step = splits.length > 1 ? Math.abs(splits[1] - splits[0]) : 1;
    let decimals = 0;
    while (decimals < 12 && Math.abs(Math.round(step * 10 ** decimals) / 10 ** decimals - step) > step * 1e-6) decimals++;
    return splits.map((value) => (value === null ? "" : signed((Math.abs(value) < step * 1e-6 ? 0 : value).toFixed(decimals))));
  }

  // What uPlot has no series for: a level across, bars of errors, diamonds around what lies outside.
  function marks(panel) {
    return (plot) => {
      const context = plot.ctx, box = plot.bbox, ratio = devicePixelRatio || 1;
      const at = (i) => plot.valToPos(plot.data[0][i], "x", true), high = (value) => plot.valToPos(value, "y", true);
      context.save();
      context.beginPath();
      context.rect(box.left, box.top, box.width, box.height);
      context.clip();
      const stroke = (colour, dash, path) => {
        context.strokeStyle = colour;
        context.lineWidth = 1.5 * ratio;
        context.setLineDash(dash);
        context.beginPath();
        path();
        context.stroke();
      };
      const across = (value) => { context.moveTo(box.left, high(value)); context.lineTo(box.left + box.width, high(value)); };
      stroke("#222", [], () => across(0));
      if (panel.level !== null && panel.level !== undefined) stroke(MARK, [6 * ratio, 4 * ratio], () => across(panel.level));
      if (panel.bars) stroke(POINT, [], () => panel.low.forEach((low, i) => {
        if (low === null) return;
        context.moveTo(at(i), high(low));
        context.lineTo(at(i), high(panel.high[i]));
      }));
      if (panel.out) stroke(MARK, [], () => panel.out.forEach((i) => {
        const x = at(i), y = high(panel.values[i]), r = 7 * ratio;
        context.moveTo(x - r, y); context.lineTo(x, y - r); context.lineTo(x + r, y); context.lineTo(x, y + r); context.closePath();
      }));
      context.restore();
    };
  }

  function draw(data, panel, place, key, all) {
    if (panel.errors) { // of symmetrical bars: their ends
      const end = (sign) => (value, i) => (value === null || panel.errors[i] === null ? null : value + sign * panel.errors[i]);
      panel.low = panel.values.map(end(-1));
      panel.high = panel.values.map(end(1));
    }
    const runs = data.kind === "runs";
    if (runs && !data.names) { // those of the page's first figure
      const first = JSON.parse(document.querySelector(".zoom script").textContent);
      data.names = first.names;
      data.dates = first.dates;
    }
    const x = runs ? data.names.map((_, i) => i) : data.x, last = x.length - 1;
    const whole = runs ? [-0.5, last + 0.5] : [x[0], x[last]];
    const columns = [x, panel.values];
    const named = (plot, value, series, i) => (i === null || i === undefined ? "" : data.names[i] + ", " + data.dates[i]);
    const value = (plot, number) => short(number);
    const series = [{ label: data.axis, value: runs ? named : value }, {
      label: panel.name, value, stroke: POINT, width: 1, points: { show: runs, size: 6, fill: POINT }, paths: runs ? () => null : undefined,
    }];
    const add = (label, part, more) => {
      if (!part) return;
      columns.push(part);
      series.push({ label, value, points: { show: false }, ...more });
    };
    add("lowest", panel.low, { stroke: "transparent" });
    add("highest", panel.high, { stroke: "transparent" });
    const bands = !runs && panel.low ? [{ series: [3, 2], fill: BAND }] : [];
    const limits = panel.limits || [];
    add("lower limit", limits[0], { stroke: MARK, dash: [5, 3] });
    add("upper limit", limits[1], { stroke: MARK, dash: [5, 3] });
    const dates = (plot, splits) => splits.map((i) => (Number.isInteger(i) && data.dates[i]) || "");
    const axis = { stroke: QUIET, grid: { stroke: "#ddd" } };
    return new uPlot({
      width: place.clientWidth, height: 190, series, bands,
      scales: { x: { time: false, range: (plot, low, high) => (low === x[0] && high === x[last] ? whole : [low, high]) } },
      axes: [{ ...axis, values: runs ? dates : ticks, incrs: runs ? [1, 2, 5, 10, 20, 50, 100, 200, 500] : undefined, space: runs ? 90 : 60 },
        { ...axis, values: ticks, size: 70, label: panel.name, labelSize: 20, labelGap: 0 }],
      cursor: {
        points: { size: 7 }, drag: { x: true, y: true, uni: 30 },
        sync: { key, filters: { pub: (type) => type === "mousemove" || type === "mouseleave" } },
      },
      hooks: {
        draw: [marks(panel)],
        setScale: [(plot, scale) => {
          const { min, max } = plot.scales.x;
          if (scale === "x") for (const other of all) if (other.scales.x.min !== min || other.scales.x.max !== max) other.setScale("x", { min, max });
        }],
      },
    }, columns, place);
  }

  function build(box, data, number) {
    const place = document.createElement("div"), tools = document.createElement("p"), said = document.createElement("span");
    const all = [], whole = () => all[0].data[0];
    place.tabIndex = 0;
    place.className = "plots";
    place.setAttribute("role", "group");
    place.setAttribute("aria-label", "Plots that zoom; keys: plus, minus, left, right, 0 for the whole");
    const range = () => [all[0].scales.x.min, all[0].scales.x.max];
    function show(low, high) {
      const first = whole()[0], last = whole()[whole().length - 1], least = (last - first) / DEEPEST;
      if (high - low >= last - first) [low, high] = [first, last];
      else if (low < first) [low, high] = [first, first + high - low];
      else if (high > last) [low, high] = [last - (high - low), last];
      if (high - low < least) return;
      all[0].setScale("x", { min: low, max: high });
      said.textContent = " " + (low === first && high === last ? "whole range" : data.axis + ": " + brief(low) + " to " + brief(high));
    }
    function move([, , factor, shift]) {
      const [low, high] = range(), middle = (low + high) / 2 + shift * (high - low), half = (factor * (high - low)) / 2;
      if (factor === Infinity) show(whole()[0], whole()[whole().length - 1]);
      else show(middle - half, middle + half);
    }
    for (const step of MOVES) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = step[0];
      button.setAttribute("aria-label", step[1]);
      button.addEventListener("click", () => move(step));
      tools.append(button, " ");
    }
    said.setAttribute("role", "status");
    tools.append(said);
    box.append(tools, place);
    for (const panel of data.panels) all.push(draw(data, panel, place, "zoom" + number, all));
    place.addEventListener("keydown", (event) => {
      if (!(event.key in KEYS) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      move(MOVES[KEYS[event.key]]);
    });
    let before = null; // of two fingers: where they were in the data
    place.addEventListener("touchstart", (event) => { before = event.touches.length === 2 ? span(event) : null; });
    place.addEventListener("touchmove", (event) => {
      if (!before || event.touches.length !== 2) return;
      event.preventDefault();
      const now = span(event), [low, high] = before.range, each = ((high - low) * before.apart) / now.apart;
      const held = low + before.middle * (high - low);
      show(held - now.middle * each, held + (1 - now.middle) * each);
    }, { passive: false });
    function span(event) {
      const box = all[0].over.getBoundingClientRect(), xs = [event.touches[0].clientX, event.touches[1].clientX];
      return { apart: Math.max(Math.abs(xs[0] - xs[1]), 10), middle: ((xs[0] + xs[1]) / 2 - box.left) / box.width, range: range() };
    }
    addEventListener("resize", () => { for (const plot of all) plot.setSize({ width: place.clientWidth, height: 190 }); });
    return [tools, place];
  }

  document.querySelectorAll(".zoom").forEach((box, number) => {
    const button = document.createElement("button");
    let parts = null;
    button.type = "button";
    button.textContent = "Zoom";
    button.setAttribute("aria-expanded", "false");
    button.setAttribute("aria-label", "Zoom: " + box.dataset.name);
    button.addEventListener("click", () => {
      const open = button.getAttribute("aria-expanded") === "false";
      button.setAttribute("aria-expanded", String(open));
      if (open && !parts) parts = build(box, JSON.parse(box.querySelector("script").textContent), number);
      else for (const part of parts) part.hidden = !open;
    });
    box.prepend(button);
    box.hidden = false;
  });
})();
