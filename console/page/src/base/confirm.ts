// A question before a step that takes something away or changes what cells recognise.
import { h } from "./dom";

export interface Question { title: string; text: string[]; action: string }

// Resolves with whether the action was chosen. Escape and Cancel decline.
export function confirmed(question: Question): Promise<boolean> {
  return new Promise((resolve) => {
    const close = (): void => dialog.close();
    const dialog = h("dialog", {
      "aria-labelledby": "question", onclose: () => {
        dialog.remove();
        resolve(dialog.returnValue === "yes");
      },
    },
    h("h2", { id: "question" }, question.title), question.text.map((each) => h("p", {}, each)),
    h("div", { className: "choices" },
      h("button", { type: "button", autofocus: true, onclick: close }, "Cancel"),
      h("button", { type: "button", className: "danger", onclick: () => dialog.close("yes") }, question.action)));
    document.body.append(dialog);
    dialog.showModal();
  });
}
