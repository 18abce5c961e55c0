// A pen that draws as that of a canvas does, and leaves SVG.

export class SvgPen {
  constructor() {
    Object.assign(this, { drawn: [], path: "", strokeStyle: "#000", fillStyle: "#000", lineWidth: 1, dashes: [] });
  }
  beginPath() { this.path = ""; }
  moveTo(x, y) { this.path += `M${x.toFixed(2)} ${y.toFixed(2)}`; }
  lineTo(x, y) { this.path += `${this.path ? "L" : "M"}${x.toFixed(2)} ${y.toFixed(2)}`; }
  closePath() { this.path += "z"; }
  rect(x, y, width, height) {
    this.moveTo(x, y);
    this.path += `h${width}v${height}h${-width}z`;
  }
  /// A whole circle.
  arc(x, y, radius) {
    this.moveTo(x - radius, y);
    this.path += `a${radius} ${radius} 0 1 0 ${2 * radius} 0a${radius} ${radius} 0 1 0 ${-2 * radius} 0z`;
  }
  setLineDash(dashes) { this.dashes = dashes; }
  stroke() {
    const dashes = this.dashes.length ? ` stroke-dasharray="${this.dashes.join(" ")}"` : "";
    this.put(`fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}"${dashes}`);
  }
  fill() { this.put(`fill="${this.fillStyle}"`); }
  put(look) {
    if (this.path) this.drawn.push(`<path ${look} d="${this.path}"/>`);
  }
}
