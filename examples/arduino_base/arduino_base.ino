// A base with two wheels for topogeo: motors on a driver with PWM and direction pins (an L298N, for
// example), one quadrature encoder for each wheel, and an emergency stop that cuts the motors.
// Protocol: docs/base_protocol.md. Board: Arduino Uno or any other with an ATmega.

#include <util/crc16.h>

// Pins. The first channel of each encoder needs an interrupt pin.
const uint8_t kEncoderA[2] = {2, 3};  // left, right
const uint8_t kEncoderB[2] = {4, 7};
const uint8_t kPwm[2] = {5, 6};
const uint8_t kDirection[2] = {8, 9};
const uint8_t kEmergencyStop = 10;  // to ground while pressed
const uint8_t kBumper = 11;         // to ground while pressed
const uint8_t kBattery = A0;

// Measure these: push the base forward by one metre and read the ticks.
const float kTicksPerMetre = 2000.0;
const float kMillivoltPerStep = 14.7;  // of the voltage divider at kBattery
const float kPwmPerSpeed = 400.0;      // duty cycle for one metre a second, without the controller
const float kGain = 300.0;             // of the error of the speed
const float kIntegralGain = 900.0;

const uint16_t kReportMs = 20;
const uint16_t kBatteryMs = 1000;
const uint8_t kLongestLine = 48;

volatile int32_t ticks[2];
float wantedSpeed[2];  // m/s
float integral[2];
int32_t lastTicks[2];
uint32_t holdUntilMs;
uint32_t reportedMs;
uint32_t batteryMs;
bool watchdogExpired;
char line[kLongestLine];
uint8_t lineLength;
bool inLine;

void leftTick() {
  ticks[0] += digitalRead(kEncoderA[0]) == digitalRead(kEncoderB[0]) ? 1 : -1;
}

void rightTick() {
  ticks[1] += digitalRead(kEncoderA[1]) == digitalRead(kEncoderB[1]) ? -1 : 1;
}

uint16_t crcOf(const char* body, uint8_t length) {
  uint16_t crc = 0;
  for (uint8_t i = 0; i < length; ++i) crc = _crc_xmodem_update(crc, body[i]);
  return crc;
}

void send(const char* body) {
  char end[8];
  snprintf(end, sizeof end, "*%04X\n", crcOf(body, strlen(body)));
  Serial.print('$');
  Serial.print(body);
  Serial.print(end);
}

bool stopPressed() {
  return digitalRead(kEmergencyStop) == LOW;
}

void stopMotors() {
  for (uint8_t i = 0; i < 2; ++i) {
    wantedSpeed[i] = 0;
    integral[i] = 0;
    analogWrite(kPwm[i], 0);
  }
}

void obey(char* body) {
  if (strcmp(body, "?") == 0) return send("H,1,arduino_base");
  if (strcmp(body, "S") == 0) return stopMotors();
  long left = 0, right = 0, holdMs = 0;
  if (sscanf(body, "V,%ld,%ld,%ld", &left, &right, &holdMs) != 3) return;
  wantedSpeed[0] = left / 1000.0;
  wantedSpeed[1] = right / 1000.0;
  holdUntilMs = millis() + constrain(holdMs, 0L, 1000L);
  watchdogExpired = false;
}

void readHost() {
  while (Serial.available() > 0) {
    const char c = Serial.read();
    if (c == '$') {
      lineLength = 0;
      inLine = true;
    } else if (inLine && c == '\n') {
      inLine = false;
      if (lineLength < 6 || line[lineLength - 5] != '*') continue;
      line[lineLength] = 0;
      const uint8_t length = lineLength - 5;
      if (strtoul(line + length + 1, nullptr, 16) != crcOf(line, length)) continue;
      line[length] = 0;
      obey(line);
    } else if (inLine && c != '\r') {
      if (lineLength + 1 < kLongestLine) {
        line[lineLength++] = c;
      } else {
        inLine = false;
      }
    }
  }
}

// Once for each report: the speeds of the wheels follow the wanted ones.
void control(const int32_t now[2]) {
  const float seconds = kReportMs / 1000.0;
  for (uint8_t i = 0; i < 2; ++i) {
    const float speed = (now[i] - lastTicks[i]) / kTicksPerMetre / seconds;
    lastTicks[i] = now[i];
    if (wantedSpeed[i] == 0 || stopPressed()) {
      integral[i] = 0;
      analogWrite(kPwm[i], 0);
      continue;
    }
    const float error = wantedSpeed[i] - speed;
    integral[i] = constrain(integral[i] + error * seconds * kIntegralGain, -255.0, 255.0);
    const float duty = kPwmPerSpeed * wantedSpeed[i] + kGain * error + integral[i];
    digitalWrite(kDirection[i], duty >= 0 ? HIGH : LOW);
    analogWrite(kPwm[i], constrain(fabs(duty), 0.0, 255.0));
  }
}

void report(uint32_t nowMs) {
  int32_t now[2];
  noInterrupts();
  now[0] = ticks[0];
  now[1] = ticks[1];
  interrupts();
  control(now);
  const uint8_t flags =
      (stopPressed() ? 1 : 0) | (watchdogExpired ? 2 : 0) | (digitalRead(kBumper) == LOW ? 4 : 0);
  char body[48];
  snprintf(body, sizeof body, "T,%lu,%ld,%ld,%u", nowMs, now[0], now[1], flags);
  send(body);
}

void setup() {
  for (uint8_t i = 0; i < 2; ++i) {
    pinMode(kEncoderA[i], INPUT_PULLUP);
    pinMode(kEncoderB[i], INPUT_PULLUP);
    pinMode(kPwm[i], OUTPUT);
    pinMode(kDirection[i], OUTPUT);
  }
  pinMode(kEmergencyStop, INPUT_PULLUP);
  pinMode(kBumper, INPUT_PULLUP);
  stopMotors();
  attachInterrupt(digitalPinToInterrupt(kEncoderA[0]), leftTick, CHANGE);
  attachInterrupt(digitalPinToInterrupt(kEncoderA[1]), rightTick, CHANGE);
  Serial.begin(115200);
  send("H,1,arduino_base");
}

void loop() {
  readHost();
  const uint32_t nowMs = millis();
  // No speeds came in time: the computer is frozen, or its cable is out.
  if ((wantedSpeed[0] != 0 || wantedSpeed[1] != 0) && static_cast<int32_t>(nowMs - holdUntilMs) >= 0) {
    stopMotors();
    watchdogExpired = true;
  }
  if (nowMs - reportedMs >= kReportMs) {
    reportedMs += kReportMs;
    report(nowMs);
  }
  if (nowMs - batteryMs >= kBatteryMs) {
    batteryMs = nowMs;
    char body[16];
    snprintf(body, sizeof body, "B,%lu",
             static_cast<unsigned long>(analogRead(kBattery) * kMillivoltPerStep));
    send(body);
  }
}
