// A button box for tomcom: each press sends the name of its button as a line of text at 115200 baud.
// Each button is soldered between its pin and ground. Which pin is which button stands here and nowhere else; the names are those
// of the layout (tomcom kitchen LAYOUT lists them), and a button's number there (gamepad) would do as well.

struct Button {
  byte pin;
  const char *name;
  bool down;
  unsigned long changed_ms;
};

Button buttons[] = {
  {2, "serve 1"}, {3, "serve 2"}, {4, "assembly_board"}, {5, "plate"}, {6, "counter"}, {7, "cutting_board"}, {8, "cooking_pot"},
  {9, "rolling_mat"}, {10, "cut"}, {11, "cook"}, {12, "shape"}, {A0, "take rice"}, {A1, "take nori"}, {A2, "take salmon"},
  {A3, "take shrimp"}, {A4, "take crab"}, {A5, "trash"},
};

// The contacts of a button bounce for some milliseconds. The first change counts at once, so a press is not delayed; those that
// follow within this time do not.
const unsigned long BOUNCES_MS = 30;

void setup() {
  Serial.begin(115200);
  for (Button &button : buttons) pinMode(button.pin, INPUT_PULLUP);
}

void loop() {
  for (Button &button : buttons) {
    bool down = digitalRead(button.pin) == LOW;
    if (down == button.down || millis() - button.changed_ms < BOUNCES_MS) continue;
    button.down = down;
    button.changed_ms = millis();
    if (down) Serial.println(button.name);
  }
}
