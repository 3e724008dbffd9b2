// Why something stands still, as the server says it, for people at the hall: without addresses of programs. A pure function.
const address = String.raw`[\w.[\]:-]*:\d+`;
const kinds: readonly (readonly [RegExp, (robot: string) => string])[] = [
  [
    new RegExp(
      `adapter at ${address} (?:broke off|ended) the feedback of a command that has not ended(?:: [^;]*)?`,
    ),
    (robot) => `the connection to ${robot} broke off before its command had ended`,
  ],
  [
    new RegExp(`adapter at ${address} cannot be reached(?:: [^;]*)?`),
    (robot) => `${robot} cannot be reached`,
  ],
  [
    new RegExp(`adapter at ${address} does not know the command, and may have forgotten it`),
    (robot) => `${robot} no longer knows the command`,
  ],
  [
    new RegExp(`adapter at ${address} cannot tell what became of it(?:: [^;]*)?`),
    (robot) => `${robot} cannot tell what became of the command`,
  ],
  [
    new RegExp(`feedback of the adapter at ${address} is refused`),
    (robot) => `what ${robot} reports is refused`,
  ],
  [new RegExp(`adapter at ${address}`), (robot) => robot],
  [/\bit is not idempotent\b/, () => "it must not be repeated unasked"],
];

// `detail`: as the server said it, where that says more.
export function reasonWords(reason: string, robot = ""): { words: string; detail: string } {
  let words = reason;
  for (const [pattern, say] of kinds) words = words.replace(pattern, () => say(robot || "the robot"));
  return words === reason ? { words, detail: "" } : { words, detail: reason };
}
