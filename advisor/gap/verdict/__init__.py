"""From evidence to the answer: verdict, causes, numbers, sentence."""
