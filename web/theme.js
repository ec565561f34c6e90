// Light or dark: as the system has it, until it is chosen here.

const KEY = "runset-theme";
const dark = matchMedia("(prefers-color-scheme: dark)");
const button = /** @type {HTMLButtonElement} */ (document.getElementById("theme"));

/** Tells of `change`. */
export const theme = new EventTarget();

export const isDark = () => (localStorage.getItem(KEY) ?? (dark.matches ? "dark" : "light")) === "dark";

function apply() {
  document.documentElement.dataset.theme = isDark() ? "dark" : "light";
  button.textContent = isDark() ? "Light" : "Dark";
  theme.dispatchEvent(new Event("change"));
}

button.addEventListener("click", () => {
  localStorage.setItem(KEY, isDark() ? "light" : "dark");
  apply();
});
dark.addEventListener("change", apply);
apply();
