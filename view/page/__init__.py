"""The page of the live view: files alone, which ``server/pages.py`` lists."""
