// A small chart of curves over time on a canvas: fast enough for live points and sliders, zoomable, linked.

const INSET = { left: 62, right: 12, top: 6, bottom: 22 };

/** From a label to its chart, and from the left to the unit, in pixels. */
const LABEL_GAP = 6;
const UNIT_AT = 2;

/** The unit and the gaps to both sides of it, in letters. */
const BESIDE_UNIT = 1.9;

/** How far from its left each card's charts begin; it only grows, or live charts would tremble. */
const lefts = new WeakMap();

/** Fewer labels don't tell a scale from a number. */
const LEAST_LABELS = 3;

/** Round steps for an axis: about so many, and never fewer than three. */
export function ticks(low, high, wanted) {
  const raw = (high - low) / Math.max(wanted, 1);
  if (!(raw > 0)) return { at: [low], digits: 2 };
  const power = 10 ** Math.floor(Math.log10(raw));
  const steps = [10, 5, 2, 1, 0.5, 0.2, 0.1].map((k) => k * power);
  const usual = steps.findLastIndex((step) => step >= raw);
  const step = steps.slice(usual).find((finer) => count(low, high, finer) >= LEAST_LABELS);
  const first = Math.ceil(low / step - 1e-9);
  const at = Array.from({ length: count(low, high, step) }, (_, k) => (first + k) * step);
  return { at, digits: Math.max(0, -Math.floor(Math.log10(step) + 1e-9)) };
}

const count = (low, high, step) => Math.floor(high / step + 1e-9) - Math.ceil(low / step - 1e-9) + 1;

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

export class Chart {
  /** `unit` stands beside the upward axis; `scale` turns values into it. */
  constructor(canvas, { unit, scale = 1, zoomed = null, least = 1e-9 }) {
    Object.assign(this, { canvas, unit, scale, zoomed, least, curves: [], bands: [], x: [0, 1], fixed: null });
    new ResizeObserver(() => this.draw()).observe(canvas);
    if (zoomed) this.listen();
  }

  /** Curves `{ x, y, colour, name }`, null in y a gap; bands are half widths around zero. */
  show(curves, x, bands = []) {
    Object.assign(this, { curves, x, bands });
    this.draw();
  }

  range() {
    if (this.fixed) return this.fixed;
    let low = Infinity, high = -Infinity;
    for (const { x, y } of this.curves) {
      for (let i = 0; i < y.length; i++) {
        if (x[i] < this.x[0] || x[i] > this.x[1] || y[i] === null) continue;
        if (y[i] < low) low = y[i];
        if (y[i] > high) high = y[i];
      }
    }
    for (const band of this.bands) { low = Math.min(low, -band); high = Math.max(high, band); }
    if (low > high) [low, high] = [-1, 1];
    const room = Math.max(0.06 * (high - low), this.least);
    return [low - room, high + room];
  }

  draw() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame(() => { this.pending = false; this.paint(); });
  }

  paint() {
    const { canvas } = this;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    const ratio = window.devicePixelRatio || 1;
    const size = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    const pen = canvas.getContext('2d');
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    const em = parseFloat(getComputedStyle(document.documentElement).fontSize);
    const [low, high] = this.range();
    this.inset = { ...INSET, left: this.leftOfAll(pen, low, high, height, em), bottom: INSET.bottom * em / 16 };
    const box = { left: this.inset.left, right: width - this.inset.right, top: this.inset.top, bottom: height - this.inset.bottom };
    const px = (x) => box.left + (x - this.x[0]) / (this.x[1] - this.x[0]) * (box.right - box.left);
    const py = (y) => box.bottom - (y - low) / (high - low) * (box.bottom - box.top);
    this.axes(pen, box, px, py, low, high, em);
    pen.save();
    pen.beginPath(); pen.rect(box.left, box.top, box.right - box.left, box.bottom - box.top); pen.clip();
    for (const band of this.bands) {
      pen.fillStyle = colour('band');
      pen.fillRect(box.left, py(band), box.right - box.left, py(-band) - py(band));
    }
    for (const curve of this.curves) this.line(pen, curve, px, py);
    if (this.dragged) {
      pen.fillStyle = colour('band');
      pen.fillRect(Math.min(...this.dragged), box.top, Math.abs(this.dragged[1] - this.dragged[0]), box.bottom - box.top);
    }
    pen.restore();
    this.legend(pen, box, em);
  }

  /** Room for numbers and unit beside all charts of one card, so that their times stand below each other. */
  leftOfAll(pen, low, high, height, em) {
    pen.font = `${0.8 * em}px system-ui, sans-serif`;
    const { at, digits } = this.upward(low, high, height - INSET.top - INSET.bottom * em / 16, em);
    const widest = Math.max(...at.map((tick) => pen.measureText(tick.toFixed(digits)).width));
    const card = this.canvas.closest('.card, dialog') ?? this.canvas;
    const left = Math.max(INSET.left * em / 16, widest + BESIDE_UNIT * em, lefts.get(card) ?? 0);
    lefts.set(card, left);
    this.canvas.dataset.besideUnit = String(left - widest - LABEL_GAP - UNIT_AT - 0.8 * em);
    return left;
  }

  upward(low, high, height, em) {
    return ticks(low * this.scale, high * this.scale, height / (1.5 * em));
  }

  axes(pen, box, px, py, low, high, em) {
    pen.font = `${0.8 * em}px system-ui, sans-serif`;
    pen.lineWidth = 1;
    const vertical = this.upward(low, high, box.bottom - box.top, em);
    pen.textAlign = 'right'; pen.textBaseline = 'middle';
    for (const tick of vertical.at) {
      const y = py(tick / this.scale);
      pen.strokeStyle = Math.abs(tick) < 1e-12 ? colour('line') : colour('grid');
      pen.beginPath(); pen.moveTo(box.left, y); pen.lineTo(box.right, y); pen.stroke();
      pen.fillStyle = colour('quiet');
      pen.fillText(tick.toFixed(vertical.digits).replace(/^-0(\.0*)?$/, '0'), box.left - LABEL_GAP, y);
    }
    const across = ticks(this.x[0], this.x[1], (box.right - box.left) / (6 * em));
    pen.textAlign = 'center'; pen.textBaseline = 'top';
    for (const tick of across.at) {
      pen.strokeStyle = colour('grid');
      pen.beginPath(); pen.moveTo(px(tick), box.top); pen.lineTo(px(tick), box.bottom); pen.stroke();
      pen.fillText(tick.toFixed(across.digits), px(tick), box.bottom + 4);
    }
    Object.assign(this.canvas.dataset, { labelsUp: vertical.at.length, labelsAcross: across.at.length });
    pen.textAlign = 'left'; pen.textBaseline = 'top';
    pen.save();
    pen.translate(UNIT_AT, (box.top + box.bottom) / 2); pen.rotate(-Math.PI / 2); pen.textAlign = 'center';
    pen.fillText(this.unit, 0, 0);
    pen.restore();
    pen.textAlign = 'right'; pen.fillText('s', box.left - 0.9 * em, box.bottom + 4);
  }

  line(pen, curve, px, py) {
    const { x, y } = curve;
    pen.strokeStyle = colour(curve.colour);
    pen.lineWidth = curve.width ?? 1.4;
    pen.lineJoin = 'round';
    pen.setLineDash(curve.dash ?? []);
    pen.beginPath();
    for (let i = 0, down = false; i < x.length; i++) {
      if (i + 1 < x.length && x[i + 1] < this.x[0]) continue;
      if (down && x[i] - x[i - 1] > (curve.gap ?? Infinity)) down = false;
      if (y[i] === null) { down = false; continue; }
      if (down) pen.lineTo(px(x[i]), py(y[i])); else pen.moveTo(px(x[i]), py(y[i]));
      down = true;
      if (x[i] > this.x[1]) break;
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  legend(pen, box, em) {
    const named = this.curves.filter((curve) => curve.name);
    if (named.length < 2) return;
    pen.textAlign = 'right'; pen.textBaseline = 'middle';
    pen.font = `${0.85 * em}px system-ui, sans-serif`;
    let right = box.right - 6;
    const y = box.top + 0.75 * em;
    for (const curve of [...named].reverse()) {
      const width = pen.measureText(curve.name).width;
      pen.fillStyle = colour('card'); pen.globalAlpha = 0.8;
      pen.fillRect(right - width - 2.3 * em, y - 0.65 * em, width + 2.4 * em, 1.3 * em);
      pen.globalAlpha = 1;
      pen.fillStyle = colour('ink'); pen.fillText(curve.name, right, y);
      pen.strokeStyle = colour(curve.colour); pen.lineWidth = 2.5; pen.setLineDash(curve.dash ?? []);
      pen.beginPath(); pen.moveTo(right - width - 1.9 * em, y); pen.lineTo(right - width - 0.5 * em, y); pen.stroke();
      pen.setLineDash([]);
      right -= width + 3 * em;
    }
  }

  /** The time under a pixel. */
  at(pixel) {
    const share = (pixel - this.inset.left) / (this.canvas.clientWidth - this.inset.left - this.inset.right);
    return this.x[0] + Math.min(Math.max(share, 0), 1) * (this.x[1] - this.x[0]);
  }

  /** Drag, wheel and keys; `zoomed(from, to)` is told, `zoomed(null)` means everything. */
  listen() {
    const { canvas } = this;
    let start = null;
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      start = { pixel: event.offsetX, x: [...this.x], moves: event.shiftKey };
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!start) return;
      if (start.moves) {
        const shift = (start.pixel - event.offsetX) / canvas.clientWidth * (start.x[1] - start.x[0]);
        this.zoomed(start.x[0] + shift, start.x[1] + shift);
      } else {
        this.dragged = [start.pixel, event.offsetX];
        this.draw();
      }
    });
    canvas.addEventListener('pointerup', () => {
      const dragged = this.dragged;
      start = null; this.dragged = null;
      if (dragged && Math.abs(dragged[1] - dragged[0]) > 5) {
        this.zoomed(this.at(Math.min(...dragged)), this.at(Math.max(...dragged)));
      }
      this.draw();
    });
    canvas.addEventListener('dblclick', () => this.zoomed(null));
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.closer(Math.exp(event.deltaY / 500), this.at(event.offsetX));
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => {
      const tenth = (this.x[1] - this.x[0]) / 10;
      const middle = (this.x[0] + this.x[1]) / 2;
      const keys = {
        '+': () => this.closer(0.7, middle), '-': () => this.closer(1 / 0.7, middle),
        ArrowLeft: () => this.zoomed(this.x[0] - tenth, this.x[1] - tenth),
        ArrowRight: () => this.zoomed(this.x[0] + tenth, this.x[1] + tenth),
        Escape: () => this.zoomed(null),
      };
      if (keys[event.key]) { keys[event.key](); event.preventDefault(); }
    });
  }

  closer(factor, around) {
    this.zoomed(around + (this.x[0] - around) * factor, around + (this.x[1] - around) * factor);
  }
}
