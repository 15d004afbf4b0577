// Numbers and names as text.

export function shortName(name: string): string {
  return name.split("/").filter((_, i) => i % 2 === 1).join(" / ");
}

export const lastPart = (name: string): string => name.slice(name.lastIndexOf("/") + 1);

export const score = (value: number): string => value.toFixed(2);

export const millimetres = (metres: number): string => `${(metres * 1000).toFixed(1)} mm`;

export const milliseconds = (value: number): string => `${value.toFixed(value < 10 ? 2 : 1)} ms`;

export const count = (value: number | bigint): string => Number(value).toLocaleString("en");

export function bytes(value: number | bigint): string {
  let size = Number(value);
  for (const unit of ["B", "KiB", "MiB", "GiB"]) {
    if (size < 1024) return `${size < 10 && unit !== "B" ? size.toFixed(1) : Math.round(size)} ${unit}`;
    size /= 1024;
  }
  return `${size.toFixed(1)} TiB`;
}

export function duration(seconds: number): string {
  const minutes = Math.floor(seconds / 60);
  if (minutes < 1) return `${seconds.toFixed(0)} s`;
  const hours = Math.floor(minutes / 60);
  if (hours < 1) return `${minutes} min`;
  const days = Math.floor(hours / 24);
  return days < 1 ? `${hours} h ${minutes % 60} min` : `${days} d ${hours % 24} h`;
}

// A time of the contract, to the minute.
export const utc = (stamp: { seconds: bigint } | undefined): string =>
  stamp ? new Date(Number(stamp.seconds) * 1000).toISOString().slice(0, 16).replace("T", " ") : "–";
