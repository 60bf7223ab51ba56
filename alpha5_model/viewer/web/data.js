// What Python knows of the scene: alpha5_model/viewer/page.py says what is in it.
export const data = JSON.parse(document.getElementById("alpha5-data").textContent);
