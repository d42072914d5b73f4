// Search: ranks the declarations of the index by a typed text. Without access to the page, so that tests can run it.
"use strict";

// Words of a text in lower case. A capital after a small letter starts a word, as in `LowPass`; digits are part of the word before them.
const wordsOf = (text) =>
  text
    .replace(/(\p{Ll})(\p{Lu})/gu, "$1 $2")
    .toLowerCase()
    .split(/[^\p{L}\p{N}]+/u)
    .filter(Boolean);

// Rank of a declaration for the words of a query, smaller is better: first matches in the name, then the name of the module, then the
// description. `NO_MATCH` if a word of the query occurs nowhere. A word of the query also matches the start of a longer word.
const NO_MATCH = 9;
const rankOf = ([name, , module, , summary, details = ""], wanted) => {
  const joined = wanted.join("");
  const nameWords = wordsOf(name);
  const nameJoined = nameWords.join("");
  if (nameJoined === joined) return 0;
  if (nameJoined.startsWith(joined)) return 1;
  const contains = (words) => wanted.every((part) => words.some((word) => word.startsWith(part)));
  if (contains(nameWords)) return 2;
  if (nameJoined.includes(joined)) return 3;
  if (wordsOf(module).join("").startsWith(joined)) return 4;
  // Adjacent words are worth more than the same words apart: "low pass" is not "a low value may pass".
  const phrase = " " + wanted.join(" ");
  const summaryWords = wordsOf(summary);
  if ((" " + summaryWords.join(" ")).includes(phrase)) return 5;
  const named = [...nameWords, ...wordsOf(module)];
  if (contains([...named, ...summaryWords])) return 6;
  const detailWords = wordsOf(details);
  if ((" " + detailWords.join(" ")).includes(phrase)) return 7;
  return contains([...named, ...summaryWords, ...detailWords]) ? 8 : NO_MATCH;
};

// At most 20 rows of the index, best match first; shorter names first among equals.
const search = (names, text) => {
  const wanted = wordsOf(text);
  if (!wanted.length) return [];
  const ranked = names.map((row) => [rankOf(row, wanted), row]).filter(([rank]) => rank < NO_MATCH);
  ranked.sort((a, b) => a[0] - b[0] || a[1][0].length - b[1][0].length || (a[1][0] < b[1][0] ? -1 : 1));
  return ranked.slice(0, 20).map(([, row]) => row);
};
