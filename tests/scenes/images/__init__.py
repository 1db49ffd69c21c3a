"""Small image files of many kinds, with the grey levels that they hold or the reason why they are refused."""
