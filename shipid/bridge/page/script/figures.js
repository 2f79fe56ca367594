// Numbers as a navigator reads them. What comes in is SI and radians; what is not known is a dash.

export const KNOT = 1852 / 3600;
export const MILE = 1852;
export const DEG = Math.PI / 180;
export const DASH = "–";

/** Whether a value is a number that can be shown. */
export const known = (value) => typeof value === "number" && Number.isFinite(value);

/** A number with a fixed count of decimals, a true minus sign and no negative zero. */
export function plain(value, decimals = 1) {
  if (!known(value)) return DASH;
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "−");
}

/** A direction in degrees, 000.0 to 359.9, without its sign of degree. */
export function degrees(angle) {
  if (!known(angle)) return "–––.–";
  const tenths = ((Math.round(angle / DEG * 10) % 3600) + 3600) % 3600;
  return (tenths / 10).toFixed(1).padStart(5, "0");
}

/** A direction, 000.0° to 359.9°. */
export const direction = (angle) => `${degrees(angle)}°`;

/** An angle or a distance to one side: P to port, S to starboard, nothing where it rounds to zero. */
export function sided(value, decimals, unit) {
  if (!known(value)) return DASH + unit;
  const size = Math.abs(value).toFixed(decimals);
  const side = Number(size) === 0 ? "" : value < 0 ? "P " : "S ";
  return `${side}${size}${unit}`;
}

/** A rudder angle: "P 10.0°" or "S 10.0°". */
export const rudder = (angle) => sided(known(angle) ? angle / DEG : null, 1, "°");

/** A speed in knots, without its unit. */
export const knots = (speed) => plain(known(speed) ? speed / KNOT : null, 1);

/** A rate of turn in degrees a minute, without its unit. */
export const perMinute = (rate) => plain(known(rate) ? rate / DEG * 60 : null, 1);

/** A distance: nautical miles, or metres below a tenth of a mile. */
export function distance(metres) {
  if (!known(metres)) return DASH;
  return Math.abs(metres) < 0.1 * MILE ? `${plain(metres, 0)} m` : `${plain(metres / MILE, 2)} nm`;
}

/** A distance to one side of a line, in metres up to a mile because a navigator corrects by ship lengths. */
export function aside(metres) {
  if (!known(metres)) return DASH;
  if (Math.abs(metres) < MILE) return `${Math.abs(metres).toFixed(0)} m${sideOf(metres, 0)}`;
  return `${(Math.abs(metres) / MILE).toFixed(2)} nm${sideOf(metres, 0)}`;
}

function sideOf(value, decimals) {
  if (Number(Math.abs(value).toFixed(decimals)) === 0) return "";
  return value < 0 ? " P" : " S";
}

/** A time as mm:ss, from an hour on as h:mm:ss. */
export function clock(seconds) {
  if (!known(seconds)) return "–:––";
  const whole = Math.round(Math.abs(seconds));
  const [h, m, s] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60, whole % 60];
  const two = (n) => String(n).padStart(2, "0");
  return `${seconds < 0 && whole ? "−" : ""}${h ? `${h}:${two(m)}` : m}:${two(s)}`;
}

/** An age: seconds, from two minutes on as mm:ss. */
export const age = (seconds) => (known(seconds) ? (seconds < 120 ? `${Math.floor(seconds)} s` : clock(seconds)) : "");

/** A coefficient with three figures that matter. */
export function coefficient(value) {
  if (!known(value)) return DASH;
  if (value !== 0 && (Math.abs(value) >= 1e4 || Math.abs(value) < 1e-3)) return value.toExponential(2).replace("-", "−").replace("e+", "e");
  const digits = value === 0 ? 2 : Math.max(0, 2 - Math.floor(Math.log10(Math.abs(value))));
  return plain(value, digits);
}

/** A value with its standard deviation: two figures of the deviation say how many of the value matter. */
export function uncertain(value, deviation) {
  if (!known(value) || !known(deviation) || !(deviation > 0)) return [coefficient(value), ""];
  const digits = Math.max(0, Math.min(6, 1 - Math.floor(Math.log10(deviation))));
  return [plain(value, digits), ` ± ${plain(deviation, digits)}`];
}

/** Read a number that a navigator typed: comma or point, a leading S or P for a side. Null where it is none. */
export function typed(text) {
  const match = /^\s*([SPsp])?\s*([+\-−]?\d*[.,]?\d+|\d+[.,]?)\s*(?:°|nm|kn)?\s*$/.exec(text);
  if (!match) return null;
  const number = Number(match[2].replace("−", "-").replace(",", "."));
  return /p/i.test(match[1] ?? "") ? -number : number;
}

/** An angle between −π and π. */
export const halfTurn = (angle) => angle - 2 * Math.PI * Math.round(angle / (2 * Math.PI));
