#!/usr/bin/env bash
# The sketch of examples/arduino_base compiles for an Arduino Uno with Debian's compiler and core, fits it, and has no
# warnings. This needs no Arduino.
source "$(dirname "${BASH_SOURCE[0]}")/../container/common.sh"

core=/usr/share/arduino/hardware/arduino/avr
if ! command -v avr-g++ > /dev/null || [ ! -e "$core/cores/arduino/Arduino.h" ]; then
  skip "avr-g++ or the Arduino core is missing" "./run packages --install check"
fi

step "the sketch"
sketch=$source_dir/examples/arduino_base/arduino_base.ino
options=(-mmcu=atmega328p -DF_CPU=16000000L -DARDUINO=10819 -DARDUINO_AVR_UNO -DARDUINO_ARCH_AVR -Os
  -ffunction-sections -fdata-sections "-I$core/cores/arduino" "-I$core/variants/standard")
mkdir -p "$work/sketch"
avr-g++ "${options[@]}" -std=gnu++11 -Wall -Wextra -Werror -include Arduino.h -x c++ -c "$sketch" \
  -o "$work/sketch/sketch.o" || fail "the sketch does not compile"

step "the core"
for source in "$core"/cores/arduino/*.cpp; do
  # Debian's compiler refuses a constant in the class String, which the sketch does not use.
  [ "${source##*/}" != WString.cpp ] || continue
  avr-g++ "${options[@]}" -std=gnu++11 -fno-exceptions -fno-threadsafe-statics -w -c "$source" \
    -o "$work/sketch/${source##*/}.o" ||
    fail "$source does not compile"
done
for source in "$core"/cores/arduino/*.c; do
  avr-gcc "${options[@]}" -std=gnu11 -w -c "$source" \
    -o "$work/sketch/${source##*/}.o" ||
    fail "$source does not compile"
done

step "linking"
avr-gcc -mmcu=atmega328p -Os -Wl,--gc-sections "$work"/sketch/*.o -lm -o "$work/sketch/sketch.elf" ||
  fail "the sketch does not link"
read -r program memory < <(avr-size "$work/sketch/sketch.elf" | awk 'NR == 2 { print $1 + $2, $2 + $3 }')
echo "$program bytes of program, $memory of memory"
[ "$program" -le 32256 ] || fail "the program has $program bytes, an Arduino Uno has room for 32256"
# The rest of 2048 bytes is for the stack.
[ "$memory" -le 1536 ] || fail "the variables have $memory bytes, expected at most 1536"
