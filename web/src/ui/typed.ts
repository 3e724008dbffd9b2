// What is typed in the field that has the keys counts when the field is left. A page that goes away, or a view that Back takes away,
// does not leave it by itself.
export function leaveField() {
  const field = document.activeElement;
  if (field instanceof HTMLInputElement || field instanceof HTMLTextAreaElement) field.blur();
}
