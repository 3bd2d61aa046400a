"""A rig from what a data sheet says: questions, assumptions where nobody knows, and the commented file."""

from hydrolek_drake.wizard.questions import Question, questions, read_answers
from hydrolek_drake.wizard.writing import rig_text

__all__ = ["Question", "questions", "read_answers", "rig_text"]
