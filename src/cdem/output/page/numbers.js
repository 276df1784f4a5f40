// Numbers as people write them: few digits, round ticks, prefixes of units.

const PREFIXES = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"]];
const TAKE_PREFIX = new Set(["Pa", "J", "N", "W", "m"]);

// Four digits at most; very large and small ones with an exponent.
function digits(value, count = 4) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) return value.toExponential(Math.min(count, 3) - 1);
  return String(Number(value.toPrecision(count)));
}

// A number to as many decimals as its smallest step has.
function rounded(value, step) {
  const decimals = Math.min(12, Math.max(0, Math.ceil(-Math.log10(step))));
  return String(Number(value.toFixed(decimals)) + 0);
}

// The factor and the unit that make numbers up to `largest` easy to read: 3.2e6 Pa are 3.2 MPa.
function scaled(largest, unit) {
  if (!TAKE_PREFIX.has(unit) || !(largest > 0)) return { factor: 1, unit };
  const [factor, prefix] = PREFIXES.find(([f]) => largest >= f) ?? PREFIXES.at(-1);
  const small = unit === "m"; // metres have small parts only, the others large multiples only
  if (small ? factor >= 1e3 : factor < 1) return { factor: 1, unit };
  return { factor, unit: prefix + unit };
}

// A number as people type it, with a comma or a point; NaN for other text.
function typed(text) {
  const trimmed = text.trim().replace(",", ".");
  return trimmed ? Number(trimmed) : NaN;
}

// The largest of 1, 2, 5 times a power of ten that is not above a value.
function roundDown(value) {
  const power = 10 ** Math.floor(Math.log10(value) + 1e-9);
  return [5, 2, 1].find((k) => k * power <= value * (1 + 1e-9)) * power;
}

// Round numbers from `low` to `high`, about `count` of them.
function ticks(low, high, count) {
  const step = roundDown(Math.max((high - low) / count, Number.MIN_VALUE)) || 1;
  const found = [];
  for (let k = Math.ceil(low / step - 1e-6); k * step <= high + 1e-6 * step; k++) found.push(k * step);
  return found;
}

// Round numbers on a logarithmic scale: powers of ten, or also 2 and 5 times them if these are few.
function logTicks(low, high) {
  const found = [], few = high / low < 100, first = Math.floor(Math.log10(low) + 1e-9);
  const last = Math.floor(Math.log10(high) + 1e-9), every = Math.ceil((last - first) / 5) || 1;
  for (let power = first; power <= last; power += every)
    for (const k of few ? [1, 2, 5] : [1]) found.push(Number(`${k}e${power}`));
  return found.filter((v) => v >= low * (1 - 1e-6) && v <= high * (1 + 1e-6));
}
