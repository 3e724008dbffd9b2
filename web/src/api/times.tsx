// Times for people: with their date where it is not today, and with year and zone in their title.
export function clock(us: bigint): string {
  return shortTime(new Date(Number(us) / 1000), true);
}
// The same for a person who has no use for seconds.
export function clockMinutes(us: bigint): string {
  return shortTime(new Date(Number(us) / 1000), false);
}
function shortTime(at: Date, seconds: boolean): string {
  const now = new Date();
  return at.toLocaleString([], {
    ...(at.toDateString() !== now.toDateString() && { day: "numeric", month: "short" }),
    ...(at.getFullYear() !== now.getFullYear() && { year: "numeric" }),
    hour: "2-digit",
    minute: "2-digit",
    ...(seconds && { second: "2-digit" }),
  });
}
// "26 November 2026 at 18:20:03 GMT+1"
export function timeTitle(us: bigint): string {
  return new Date(Number(us) / 1000).toLocaleString([], {
    day: "numeric",
    month: "long",
    year: "numeric",
    hour: "2-digit",
    minute: "2-digit",
    second: "2-digit",
    timeZoneName: "short",
  });
}
export function Time({ us, className }: { us: bigint; className?: string }) {
  return (
    <time className={className} dateTime={new Date(Number(us) / 1000).toISOString()} title={timeTitle(us)}>
      {clock(us)}
    </time>
  );
}
