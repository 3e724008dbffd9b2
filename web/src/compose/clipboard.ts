// Steps that are copied and pasted, as text of the browser's clipboard.
import { toast } from "../ui/toasts";
import type { Actions } from "./actions";

let memory = ""; // what was copied last, where the browser's clipboard is closed

export function clipboardOf(actions: Actions) {
  return {
    copy: (keys: string[]) => {
      const text = actions.copied(keys);
      if (!text) return toast("bad", "Nothing to copy", "Select steps first.");
      memory = text;
      void navigator.clipboard?.writeText(text).catch(() => undefined);
      toast("good", keys.length === 1 ? "The step is copied" : `${keys.length} steps are copied`);
    },
    paste: async () => {
      const text = await navigator.clipboard?.readText().catch(() => memory);
      actions.paste(text || memory);
    },
  };
}
