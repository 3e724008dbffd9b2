// The way by which a flow was opened in place: the steps that lead into it, outermost first, as they stand in the address.
export interface Opened {
  name: string; // of the document
  flow: string;
  step: string; // that runs the flow
}
const most = 20;

export function viaText(opened: readonly Opened[]): string {
  return opened
    .slice(-most)
    .map((o) => [o.name, o.flow, o.step].map(encodeURIComponent).join("/"))
    .join("|");
}
export function readVia(text: string): Opened[] {
  try {
    return text
      .split("|")
      .filter(Boolean)
      .map((part) => {
        const [name = "", flow = "", step = ""] = part.split("/").map(decodeURIComponent);
        return { name, flow, step };
      })
      .filter((o) => o.name !== "");
  } catch {
    return []; // not made by the app
  }
}
