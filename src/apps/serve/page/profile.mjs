// A vertical profile: heights over the way along the picked line, in equal scales.
export function drawProfile(canvas, profile) {
  canvas.hidden = !profile;
  if (!profile) return;
  const paper = canvas.getContext('2d'), left = 56, below = 24;
  const heights = profile.points.map(p => p[1]);
  const low = heights.reduce((a, b) => Math.min(a, b), Infinity), high = heights.reduce((a, b) => Math.max(a, b), -Infinity);
  const scale = Math.min((canvas.width - left - 8) / (profile.length || 1), (canvas.height - below - 8) / (high - low || 1));
  const style = getComputedStyle(canvas);
  paper.clearRect(0, 0, canvas.width, canvas.height);
  const x = along => left + along * scale, y = height => canvas.height - below - (height - low) * scale;
  for (const [along, height, color] of profile.points) {
    paper.fillStyle = color;
    paper.fillRect(x(along) - 1, y(height) - 1, 2, 2);
  }
  paper.fillStyle = style.color;
  paper.font = '16px system-ui, sans-serif';
  paper.fillText(low.toPrecision(5), 2, y(low));
  paper.fillText(high.toPrecision(5), 2, Math.max(16, y(high) + 6));
  paper.fillText(`0 to ${profile.length.toPrecision(4)}, ${profile.count.toLocaleString('en')} points`, left, canvas.height - 4);
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('aria-label', `profile of ${profile.count} points, ${profile.length.toPrecision(4)} long, heights from ${low.toPrecision(5)} to ${high.toPrecision(5)}`);
}
