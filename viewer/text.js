// SPDX-License-Identifier: Apache-2.0
// Numbers and amounts in readable form.

const whole = new Intl.NumberFormat("en");

export function count(n) {
    return whole.format(n);
}

export function amount(n, singular, plural) {
    return `${count(n)} ${n === 1 ? singular : plural}`;
}

/** Percent with one decimal; never rounded up to 100 nor down to 0. */
export function percent(fraction) {
    const rounded = Math.round(fraction * 1000) / 10;
    if (fraction < 1 && rounded === 100) return "> 99.9 %";
    if (fraction > 0 && rounded === 0) return "< 0.1 %";
    return `${rounded} %`;
}

export function real(x) {
    return Math.abs(x) < 1e6 ? String(Number(x.toPrecision(4))) : x.toExponential(2);
}

export function point(p) {
    return p.map(real).join(", ");
}
