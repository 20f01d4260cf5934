#include "graphdrl/io/utf8.h"

#include <boost/locale/utf.hpp>
#include <charconv>
#include <iterator>
#include <unordered_map>
#include <unordered_set>

#include "graphdrl/io/text.h"

namespace graphdrl {
namespace {

using Traits = boost::locale::utf::utf_traits<char>;

// Names of HTML 4 [w3.org/TR/html401/sgml/entities.html], of the characters from each number on.
constexpr std::string_view kEntities =
    "34 quot 38 amp 60 lt 62 gt 160 nbsp iexcl cent pound curren yen brvbar sect uml copy ordf laquo not shy reg "
    "macr deg plusmn sup2 sup3 acute micro para middot cedil sup1 ordm raquo frac14 frac12 frac34 iquest Agrave "
    "Aacute Acirc Atilde Auml Aring AElig Ccedil Egrave Eacute Ecirc Euml Igrave Iacute Icirc Iuml ETH Ntilde Ograve "
    "Oacute Ocirc Otilde Ouml times Oslash Ugrave Uacute Ucirc Uuml Yacute THORN szlig agrave aacute acirc atilde "
    "auml aring aelig ccedil egrave eacute ecirc euml igrave iacute icirc iuml eth ntilde ograve oacute ocirc otilde "
    "ouml divide oslash ugrave uacute ucirc uuml yacute thorn yuml 338 OElig oelig 352 Scaron scaron 376 Yuml 402 "
    "fnof 710 circ 732 tilde 913 Alpha Beta Gamma Delta Epsilon Zeta Eta Theta Iota Kappa Lambda Mu Nu Xi Omicron Pi "
    "Rho 931 Sigma Tau Upsilon Phi Chi Psi Omega 945 alpha beta gamma delta epsilon zeta eta theta iota kappa lambda "
    "mu nu xi omicron pi rho sigmaf sigma tau upsilon phi chi psi omega 977 thetasym upsih 982 piv 8194 ensp emsp "
    "8201 thinsp 8204 zwnj zwj lrm rlm 8211 ndash mdash 8216 lsquo rsquo sbquo 8220 ldquo rdquo bdquo 8224 dagger "
    "Dagger bull 8230 hellip 8240 permil 8242 prime Prime 8249 lsaquo rsaquo 8254 oline 8260 frasl 8364 euro 8465 "
    "image 8472 weierp 8476 real 8482 trade 8501 alefsym 8592 larr uarr rarr darr harr 8629 crarr 8656 lArr uArr "
    "rArr dArr hArr 8704 forall 8706 part exist 8709 empty 8711 nabla isin notin 8715 ni 8719 prod 8721 sum minus "
    "8727 lowast 8730 radic 8733 prop infin 8736 ang 8743 and or cap cup int 8756 there4 8764 sim 8773 cong 8776 "
    "asymp 8800 ne equiv 8804 le ge 8834 sub sup nsub 8838 sube supe 8853 oplus 8855 otimes 8869 perp 8901 sdot 8968 "
    "lceil rceil lfloor rfloor 9001 lang rang 9674 loz 9824 spades 9827 clubs 9829 hearts diams 39 apos";

std::uint32_t number_of(std::string_view digits, int base) {
  std::uint32_t code = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), code, base);
  return error == std::errc() && end == digits.data() + digits.size() ? code : 0;
}

std::unordered_map<std::string_view, std::uint32_t> codes_of_names() {
  std::unordered_map<std::string_view, std::uint32_t> codes;
  std::uint32_t next = 0;
  for (std::string_view rest = kEntities; !rest.empty();) {
    const std::string_view word = take_word(rest);
    const std::uint32_t number = number_of(word, 10);
    if (number == 0) codes[word] = next;
    next = number == 0 ? next + 1 : number;
  }
  return codes;
}

// The character that `&name;` stands for; empty where it stands for none.
std::string character_of(std::string_view name) {
  static const auto codes = codes_of_names();
  if (name.starts_with("#x") || name.starts_with("#X")) return utf8_of(number_of(name.substr(2), 16));
  if (name.starts_with('#')) return utf8_of(number_of(name.substr(1), 10));
  const auto found = codes.find(name);
  return found == codes.end() ? std::string() : utf8_of(found->second);
}

}  // namespace

Utf8Character utf8_at(std::string_view text, std::size_t at) {
  const char* const begin = text.data() + at;
  const char* next = begin;
  const auto code = Traits::decode(next, text.data() + text.size());
  if (!boost::locale::utf::is_valid_codepoint(code)) return {kReplacement, 1};
  return {code, static_cast<std::size_t>(next - begin)};
}

std::string utf8_of(std::uint32_t code) {
  std::string text;
  if (code != 0 && boost::locale::utf::is_valid_codepoint(code)) Traits::encode(code, std::back_inserter(text));
  return text;
}

bool is_utf8(std::string_view text) {
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    if (!boost::locale::utf::is_valid_codepoint(Traits::decode(at, end))) return false;
  }
  return true;
}

std::string valid_utf8(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (std::size_t at = 0; at < text.size();) {
    const Utf8Character character = utf8_at(text, at);
    Traits::encode(character.code, std::back_inserter(result));
    at += character.bytes;
  }
  return result;
}

std::vector<std::string> fitted_labels(std::span<const std::string> labels, std::string (*fit)(std::string_view)) {
  std::vector<std::string> fitted;
  for (const std::string& label : labels) fitted.push_back(fit(label));
  const std::unordered_set<std::string_view> different(fitted.begin(), fitted.end());
  if (different.size() != fitted.size()) fitted.clear();
  return fitted;
}

std::string without_entities(std::string_view text) {
  constexpr std::size_t kLongest = 10;
  std::string result;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '&') {
      const std::string_view rest = text.substr(at + 1, kLongest);
      const std::size_t end = rest.find(';');
      const std::string character = end == std::string_view::npos ? "" : character_of(rest.substr(0, end));
      if (!character.empty()) {
        result += character;
        at += end + 1;
        continue;
      }
    }
    result += text[at];
  }
  return result;
}

}  // namespace graphdrl
