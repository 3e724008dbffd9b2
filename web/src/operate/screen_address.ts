// The address of a robot's screen, from what the graph says of its page; undefined where that is no web address. Anybody may tell it.
export function screenAddress(page: string | undefined): string | undefined {
  if (!page || !/^https?:\/\//.test(page)) return undefined;
  try {
    return new URL("/", page).href;
  } catch {
    return undefined;
  }
}
