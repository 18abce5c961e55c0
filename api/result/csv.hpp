#pragma once

#include <vector>

#include "api/document/piece_writer.hpp"
#include "result/solution.hpp"

/// Tables for spreadsheets as RFC 4180 has them: UTF-8, a header line, lines that end with CR LF, numbers
/// by shortest round trip with a decimal point. They return false if the sink ended it.
namespace signorini::api {

/// A row an iteration, with the columns of the `history` member of a result.
bool write_history_csv(const std::vector<Iteration>& history, const Sink& sink);

/// A row a contact edge (P0) or node (P1): `part,x,y,clearance,pressure,gap,open`.
///
/// The name of a part is the client's and must not become a formula in somebody's spreadsheet: a name that
/// begins with = + - @, a tab or a line break gets an apostrophe in front, which spreadsheets do not take
/// for the start of one. A name that begins with an apostrophe gets another, so that a program may always
/// take the first one off.
bool write_contact_csv(const std::vector<ContactPart>& parts, const Sink& sink);

/// A row a quantity: `name,value,estimate,lower,upper,guaranteed`; without a finite interval its ends are
/// empty.
bool write_quantities_csv(const std::vector<EnclosedQuantity>& quantities, const Sink& sink);

/// A row a mesh and scheme, with the columns of study_columns.hpp; what a row does not have is empty.
bool write_study_csv(const std::vector<StudyRow>& rows, const Sink& sink);

}  // namespace signorini::api
