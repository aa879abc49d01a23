/** A time rounded to 12 significant digits, as `model.instants.instant`: times that mean the same are the same. */
export function instant(t: number): number {
  return Number.isFinite(t) && t !== 0 ? Number(t.toPrecision(12)) : t;
}
